// Message <-> frame. Allocates nothing, reads nothing past a frame's end, and covers all of its bytes.
#pragma once

#include <span>

#include "common/result.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/frame_type.hpp"
#include "common/wire/messages.hpp"

namespace octoskin::wire {

/// In the order of the checks. The receiver counts each one separately.
enum class DecodeError : std::uint8_t {
    foreign_format,  ///< extended, remote or error frame; FD where the type is classical, or the reverse
    unknown_type,    ///< a reserved or unassigned identifier, or a node id that its type does not allow
    wrong_length,
    wrong_crc,
    wrong_version,  ///< CRC valid, version not ours
    nonzero_padding,
    invalid_field,  ///< a value outside its enumeration or range
};
inline constexpr std::size_t kDecodeErrors = 7;
[[nodiscard]] const char* name(DecodeError error) noexcept;

struct Decoded {
    NodeId node_id = 0;
    Message message;
};

/// The type of the frame that carries `message`.
[[nodiscard]] FrameType type_of(const Message& message) noexcept;

/// The frame for `message` from (for commands: to) `node_id`. A value that its field cannot hold and a node
/// id that the message's type does not allow are programmer's errors (asserted); fields documented to
/// saturate do so. Cost: < 1 us on a PC; no heap; from any thread or interrupt.
[[nodiscard]] CanFrame encode(const Message& message, NodeId node_id) noexcept;

/// The message in `frame`. The checks, in this order: format, type, length, CRC, version, padding, field
/// ranges. Safe for any bytes, any length and any flags. The bit rate switch is ignored.
[[nodiscard]] Result<Decoded, DecodeError> decode(const CanFrame& frame) noexcept;

/// The same for a standard data frame whose payload is stored elsewhere. Reads only `payload`.
[[nodiscard]] Result<Decoded, DecodeError> decode(std::uint32_t standard_id, bool is_fd,
                                                  std::span<const std::uint8_t> payload) noexcept;

}  // namespace octoskin::wire
