#include "firmware/core/alike_differences.hpp"

#include <algorithm>

namespace octoskin::node {

using vl53l1x::RegisterDifference;

bool AlikeDifferences::update() noexcept {
    std::uint32_t seen = 0;
    for (const auto& sensor : sensors_) {
        if (sensor) seen += sensor->read_back().lasting_count();
    }
    if (seen == seen_) return false;
    seen_ = seen;
    bool has_learnt = false;
    for (const auto& sensor : sensors_) {
        if (!sensor) continue;
        has_learnt = learn_any(sensor->read_back().deciding_differences()) || has_learnt;
        has_learnt = learn_any(sensor->read_back().exempt_differences()) || has_learnt;
    }
    return has_learnt;
}

bool AlikeDifferences::learn_any(std::span<const RegisterDifference> differences) noexcept {
    bool has_learnt = false;
    for (const RegisterDifference& difference : differences) {
        const std::uint8_t parts = parts_with(difference);
        if (parts < kPartsMin || !verification_.learn(difference)) continue;
        learnt_[learnt_count_++] = {.difference = difference, .parts = parts};
        has_learnt = true;
    }
    return has_learnt;
}

std::uint8_t AlikeDifferences::parts_with(const RegisterDifference& difference) const noexcept {
    const auto has_it = [&](const RegisterDifference& other) { return is_alike(other, difference); };
    return static_cast<std::uint8_t>(std::ranges::count_if(sensors_, [&](const auto& sensor) {
        return sensor && (std::ranges::any_of(sensor->read_back().deciding_differences(), has_it) ||
                          std::ranges::any_of(sensor->read_back().exempt_differences(), has_it));
    }));
}

}  // namespace octoskin::node
