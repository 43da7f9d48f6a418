#include "host/apps/rig/sensor_ring.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "host/core/kinematics/capsule.hpp"

namespace octoskin {
namespace {

constexpr double kHeightMax_m = 2.0;
constexpr double kOutside_m = 10.0;
constexpr double kMillimetre_m = 1e-3;
constexpr double kRounding = 1e-6;  // of a millimetre

template <class Number>
std::optional<Number> number_of(std::string_view text) {
    Number value{};
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec != std::errc{} || parsed.ptr != text.data() + text.size()) return std::nullopt;
    return value;
}

/// The disc, or the stadium, in which a capsule meets the plane at `height_m`, as its extent in x and y.
std::optional<Eigen::AlignedBox2d> cut_of(const rig::Capsule& capsule, double height_m) {
    Eigen::AlignedBox2d cut;
    constexpr int kSteps = 100;
    for (int i = 0; i <= kSteps; ++i) {
        const Eigen::Vector3d centre =
            capsule.p_link_a + i / double{kSteps} * (capsule.p_link_b - capsule.p_link_a);
        const double above_m = height_m - centre.z();
        const double half2 = capsule.radius_m * capsule.radius_m - above_m * above_m;
        if (half2 <= 0.0) continue;
        const Eigen::Vector2d half = Eigen::Vector2d::Constant(std::sqrt(half2));
        cut.extend(centre.head<2>() - half);
        cut.extend(centre.head<2>() + half);
    }
    return cut.isEmpty() ? std::nullopt : std::optional(cut);
}

}  // namespace

Result<SensorRing, Error> sensor_ring_of(std::string_view text) {
    const auto refused = [text] {
        return unexpected(Error{
            .code = ErrorCode::bad_argument,
            .what =
                fmt::format("expected LINK,N,Z: a link, 1 to {} sensors, and metres along its z, at most {}",
                            kRigSensorsMax, kHeightMax_m),
            .value = fmt::format("'{}'", text),
            .remedy = "write for example forearm_link,8,0.2",
            .key = "--ring"});
    };
    const auto last = text.rfind(',');
    const auto first = last == std::string_view::npos || last == 0 ? last : text.rfind(',', last - 1);
    if (first == std::string_view::npos || first == last || first == 0) return refused();
    const auto count = number_of<std::size_t>(text.substr(first + 1, last - first - 1));
    const auto height_m = number_of<double>(text.substr(last + 1));
    if (!count || *count == 0 || *count > kRigSensorsMax || !height_m ||
        !(std::abs(*height_m) <= kHeightMax_m))
        return refused();
    return SensorRing{std::string(text.substr(0, first)), *count, *height_m};
}

Result<std::vector<RingPlace>, Error> places_of(const SensorRing& ring, std::span<const rig::Capsule> body) {
    Eigen::AlignedBox2d cut;
    std::vector<PosedCapsule> capsules;
    for (const rig::Capsule& capsule : body) {
        if (capsule.link != ring.link) continue;
        const auto part = cut_of(capsule, ring.height_m);
        if (!part) continue;
        cut.extend(*part);
        capsules.push_back({capsule.p_link_a, capsule.p_link_b, capsule.radius_m});
    }
    if (capsules.empty()) {
        return unexpected(
            Error{.code = ErrorCode::no_data,
                  .what = fmt::format("link {} has no body at z = {} m, so nothing to place sensors on",
                                      ring.link, ring.height_m),
                  .remedy = "give another height, or a body: `octoskin robot` prints what each link has",
                  .key = "--ring"});
    }
    const Eigen::Vector3d middle(cut.center().x(), cut.center().y(), ring.height_m);
    std::vector<RingPlace> places;
    for (std::size_t i = 0; i < ring.count; ++i) {
        const double azimuth =
            2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(ring.count);
        const Eigen::Vector3d outward(std::cos(azimuth), std::sin(azimuth), 0.0);
        double surface_m = 0.0;
        for (const PosedCapsule& capsule : capsules) {
            const auto entry = ray_entry(capsule, middle + kOutside_m * outward, -outward);
            if (entry) surface_m = std::max(surface_m, kOutside_m - *entry);
        }
        const double rounded_m = kMillimetre_m * std::ceil(surface_m / kMillimetre_m - kRounding);
        places.push_back({middle + rounded_m * outward, azimuth * 180.0 / std::numbers::pi});
    }
    return places;
}

}  // namespace octoskin
