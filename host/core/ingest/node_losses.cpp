#include "host/core/ingest/node_losses.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace octoskin {
namespace {

constexpr std::int64_t kTenthNs = 100'000'000;

std::int64_t index_of(HostTime at) {
    return at.ns / kTenthNs;
}

}  // namespace

bool is_loss(ReadingReason reason) noexcept {
    const bool is_of_clock = reason == ReadingReason::clock_in_doubt || reason == ReadingReason::clock_silent;
    const bool is_of_word =  // a usable node reported none of these itself: another sender did
        reason == ReadingReason::node_time_suspect || reason == ReadingReason::node_info_mismatch;
    return is_of_clock || is_of_word ||
           (reason > ReadingReason::duplicate && reason <= ReadingReason::too_old);
}

NodeLosses::Tenth& NodeLosses::tenth_of(HostTime now) {
    const std::int64_t index = index_of(now);
    Tenth& tenth = tenths_[static_cast<std::size_t>(index) % kTenths];
    if (tenth.index != index) tenth = {.index = index, .readings = 0, .refused = {}};
    return tenth;
}

void NodeLosses::on_refused(HostTime now, ReadingReason reason) {
    all_.reject(reason);
    if (is_loss(reason)) tenth_of(now).refused[static_cast<std::size_t>(reason)] += 1;
}

std::optional<NodeLosses::Loss> NodeLosses::worth_a_word(HostTime now) const {
    std::uint32_t readings = 0;
    std::array<std::uint32_t, kReasons> refused{};
    for (const Tenth& tenth : tenths_) {
        const std::int64_t ago = index_of(now) - tenth.index;
        if (ago < 0 || ago >= static_cast<std::int64_t>(kTenths)) continue;
        readings += tenth.readings;
        std::ranges::transform(refused, tenth.refused, refused.begin(), std::plus<>{});
    }
    const std::uint32_t all = std::accumulate(refused.begin(), refused.end(), 0U);
    if (readings == 0 || all < 2 || all <= kShareMax * readings) return std::nullopt;
    const auto most = std::ranges::max_element(refused) - refused.begin();
    return Loss{std::min(1.0, static_cast<double>(all) / readings), static_cast<ReadingReason>(most)};
}

}  // namespace octoskin
