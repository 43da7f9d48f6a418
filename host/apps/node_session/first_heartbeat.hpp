// Messages about a node without communication: it is silent, or uses another protocol version.
#pragma once

#include <optional>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// A working node sends 20 heartbeats in this time.
inline constexpr Nanoseconds kHeartbeatWithin{2'000'000'000};
inline constexpr const char* kNoHeartbeat =
    "no heartbeat for 2 s: is it powered, on this bus, and at this bit rate?";

/// For a frame that `wire::decode` refused with `error`: the message if the frame is a heartbeat of `node` in
/// another protocol version; empty otherwise.
[[nodiscard]] std::optional<std::string> other_version(const wire::CanFrame& frame, wire::DecodeError error,
                                                       wire::NodeId node);

}  // namespace octoskin
