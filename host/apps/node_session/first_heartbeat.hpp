// Messages about a node without communication: it is silent, or uses another protocol version.
#pragma once

#include <optional>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/messages.hpp"
#include "host/errors/error.hpp"

namespace octoskin {

/// A working node sends 20 heartbeats in this time.
inline constexpr Nanoseconds kHeartbeatWithin{2'000'000'000};
/// The error of a node without a heartbeat in this time.
[[nodiscard]] Error no_heartbeat();

/// For a frame that `wire::decode` refused with `error`: the error if the frame is a heartbeat of `node` in
/// another protocol version; empty otherwise.
[[nodiscard]] std::optional<Error> other_version(const wire::CanFrame& frame, wire::DecodeError error,
                                                 wire::NodeId node);

}  // namespace octoskin
