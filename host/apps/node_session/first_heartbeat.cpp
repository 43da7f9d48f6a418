#include "host/apps/node_session/first_heartbeat.hpp"

#include <fmt/format.h>

#include "common/wire/frame_type.hpp"

namespace octoskin {

std::optional<std::string> other_version(const wire::CanFrame& frame, wire::DecodeError error,
                                         wire::NodeId node) {
    constexpr unsigned kVersionMask = 7;  // the same in all versions: docs/protocol.md
    const bool is_its_heartbeat = frame.can_id == wire::can_id(wire::FrameType::heartbeat, node);
    if (!is_its_heartbeat || error != wire::DecodeError::wrong_version) return std::nullopt;
    return fmt::format("it uses protocol version {}, this program {}: flash it", frame.data[0] & kVersionMask,
                       wire::kProtocolVersion);
}

}  // namespace octoskin
