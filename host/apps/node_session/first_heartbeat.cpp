#include "host/apps/node_session/first_heartbeat.hpp"

#include <fmt/format.h>

#include "common/wire/frame_type.hpp"

namespace octoskin {

Error no_heartbeat() {
    return {.code = ErrorCode::no_answer,
            .what = "no heartbeat for 2 s",
            .remedy = "check that it is powered, on this bus, and at this bit rate"};
}

std::optional<Error> other_version(const wire::CanFrame& frame, wire::DecodeError error, wire::NodeId node) {
    constexpr unsigned kVersionMask = 7;  // the same in all versions: docs/protocol.md
    const bool is_its_heartbeat = frame.can_id == wire::can_id(wire::FrameType::heartbeat, node);
    if (!is_its_heartbeat || error != wire::DecodeError::wrong_version) return std::nullopt;
    return Error{.code = ErrorCode::unsupported,
                 .what = fmt::format("expected protocol version {}", wire::kProtocolVersion),
                 .value = fmt::format("{}", frame.data[0] & kVersionMask),
                 .remedy = "flash the node"};
}

}  // namespace octoskin
