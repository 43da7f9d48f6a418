// What a person is told of a node that cannot be talked to: it is silent, or speaks another version.
#pragma once

#include <optional>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// A node that is there has sent twenty by then.
inline constexpr Nanoseconds kHeartbeatWithin{2'000'000'000};
inline constexpr const char* kNoHeartbeat =
    "no heartbeat for 2 s: has it power, is it on this bus, at this bit rate?";

/// Of a frame that `wire::decode` refused with `error`: what to say if it is a heartbeat of `node` in another
/// version of the protocol; empty if it is anything else.
[[nodiscard]] std::optional<std::string> other_version(const wire::CanFrame& frame, wire::DecodeError error,
                                                       wire::NodeId node);

}  // namespace octoskin
