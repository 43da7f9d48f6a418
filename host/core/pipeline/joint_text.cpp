#include "host/core/pipeline/joint_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <iterator>

namespace octoskin {
namespace {

double ms(Nanoseconds time) {
    return 1e-6 * static_cast<double>(time.count());
}

}  // namespace

std::string beyond_text(const JointBeyond& beyond, std::span<const std::string> names) {
    assert(beyond.joint < names.size());
    return fmt::format(
        "joint samples beyond the limits are not used: {} is {:.6g}; its limits are {:.6g} to {:.6g}",
        names[beyond.joint], beyond.position, beyond.limits.min, beyond.limits.max);
}

std::string unknown_text(std::span<const std::uint64_t> times, std::span<const std::string> names) {
    assert(times.size() == names.size());
    if (times.empty() || std::ranges::count(times, times.front()) == std::ssize(times)) return {};
    const std::uint64_t most = std::ranges::max(times);
    std::string text;
    for (std::size_t i = 0; i < times.size(); ++i)
        if (times[i] == most) text += fmt::format("{}{}", text.empty() ? "" : ", ", names[i]);
    return fmt::format(" No position was known of {} ({} times).", text, most);
}

std::string gap_text(const JointGap& gap, const JointHistoryConfig& config) {
    return fmt::format(
        "Joint samples are {:.0f} ms apart; at most {:.0f} ms are bridged, and {:.0f} ms to the nearer one.",
        ms(gap.between), ms(config.bracket_max), ms(config.nearest_max));
}

}  // namespace octoskin
