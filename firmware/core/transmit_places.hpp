// Which frames may wait together in a node's CAN controller, which sends the lowest identifier first. Every
// port and every model of one keeps to this, so that no frame of the node waits behind a less urgent one of
// its own.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/wire/frame_type.hpp"

namespace octoskin::node {

inline constexpr std::size_t kTransmitPlaces = 3;

/// Whether a frame of `can_id` may join those that wait or are on the wire. Never two of one identifier: such
/// a controller does not guarantee their order, nor the sequence of readings. The last place is kept for
/// REFLEX: otherwise a bus busy with other nodes' frames would delay it behind this node's less urgent ones.
[[nodiscard]] constexpr bool may_join(std::span<const std::uint32_t> waiting, std::uint32_t can_id) noexcept {
    if (std::ranges::find(waiting, can_id) != waiting.end()) return false;
    const bool is_reflex = wire::type_of(can_id) == wire::FrameType::reflex;
    return waiting.size() < (is_reflex ? kTransmitPlaces : kTransmitPlaces - 1);
}

}  // namespace octoskin::node
