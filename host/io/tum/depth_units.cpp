#include "host/io/tum/depth_units.hpp"

#include <fmt/format.h>

namespace octoskin::tum {
namespace {

/// Counts of the pixels that have a value.
struct Shares {
    std::uint64_t all = 0;
    std::uint64_t too_near = 0;     ///< nearer than depth_min_m, at the present scale
    std::uint64_t within_1_m = 0;   ///< at the present scale
    std::uint64_t no_fives = 0;     ///< values that are not multiples of 5
    std::uint64_t over_10_000 = 0;  ///< values above 10 m in millimetres
};

Shares shares_of(const PixelValues& values, const rig::DataSetDepth& scale, double depth_min_m) {
    constexpr std::uint32_t kSaturated = PixelValues::kValues - 1;
    Shares shares;
    for (std::uint32_t value = 1; value < kSaturated; ++value) {
        const std::uint64_t count = values.count(static_cast<std::uint16_t>(value));
        if (count == 0 || value == scale.no_value) continue;
        const double depth_m = value / scale.units_per_m;
        shares.all += count;
        if (depth_m < depth_min_m) shares.too_near += count;
        if (depth_m < 1.0) shares.within_1_m += count;
        if (value % 5 != 0) shares.no_fives += count;
        if (value > 10'000) shares.over_10_000 += count;
    }
    return shares;
}

bool are_nearly_all(std::uint64_t part, std::uint64_t all) {
    return 20 * part >= 19 * all;
}

/// "; if the values are millimetres, ..."
std::string remedy(const rig::DataSetDepth& scale) {
    if (scale.units_per_m <= 1000.0)
        return "set data_set.depth_units_per_m of the rig's camera to the data set's value, or lower "
               "depth_min_m";
    return "if the values are millimetres, set data_set.depth_units_per_m: 1000 in the camera of a --rig";
}

}  // namespace

std::optional<std::string> doubt_units(const PixelValues& values, const rig::DataSetDepth& scale,
                                       double depth_min_m) {
    const Shares shares = shares_of(values, scale, depth_min_m);
    if (shares.all == 0) return std::nullopt;
    const auto percent = [&](std::uint64_t part) {
        return 100.0 * static_cast<double>(part) / static_cast<double>(shares.all);
    };
    if (2 * shares.too_near > shares.all) {
        return fmt::format(
            "{:.0f} % of the pixels are nearer than depth_min_m, {:g} m, at {:g} units a metre: {}",
            percent(shares.too_near), depth_min_m, scale.units_per_m, remedy(scale));
    }
    if (scale.units_per_m != rig::DataSetDepth{}.units_per_m) return std::nullopt;
    if (2 * shares.no_fives > shares.all && are_nearly_all(shares.all - shares.over_10_000, shares.all)) {
        return fmt::format(
            "{:.0f} % of the values are not multiples of 5, as a camera's millimetres are at {:g} units a "
            "metre: {}",
            percent(shares.no_fives), scale.units_per_m, remedy(scale));
    }
    if (are_nearly_all(shares.within_1_m, shares.all)) {
        return fmt::format("{:.0f} % of the pixels are nearer than 1 m at {:g} units a metre: {}",
                           percent(shares.within_1_m), scale.units_per_m, remedy(scale));
    }
    return std::nullopt;
}

}  // namespace octoskin::tum
