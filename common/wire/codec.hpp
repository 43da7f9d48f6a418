// Message <-> frame. Allocates nothing, reads nothing past a frame's end, and takes all of its bytes into
// account.
#pragma once

#include <span>

#include "common/result.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/frame_type.hpp"
#include "common/wire/messages.hpp"

namespace octoskin::wire {

/// In the order of the checks. Each is a counter of its own at the receiver.
enum class DecodeError : std::uint8_t {
    foreign_format,  ///< extended, remote or error frame, or FD where classical belongs and the reverse
    unknown_type,    ///< an identifier that is reserved, not assigned, or with a node id its type does not
                     ///< allow
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

/// The frame for `message` from (or, for commands, to) `node_id`. A value that its field cannot hold, and a
/// node id that the message's type does not allow, are programmer's mistakes and assert, except in the fields
/// documented to saturate. Cost: < 1 us on a PC; no heap; from any thread or interrupt.
[[nodiscard]] CanFrame encode(const Message& message, NodeId node_id) noexcept;

/// The message in `frame`. The checks, in this order: format, type, length, CRC, version, padding, field
/// ranges. Any bytes, any length and any flags are safe. Whether the bit rate was switched makes no
/// difference.
[[nodiscard]] Result<Decoded, DecodeError> decode(const CanFrame& frame) noexcept;

/// The same for a standard data frame whose payload lies elsewhere; reads nothing but `payload`.
[[nodiscard]] Result<Decoded, DecodeError> decode(std::uint32_t standard_id, bool is_fd,
                                                  std::span<const std::uint8_t> payload) noexcept;

}  // namespace octoskin::wire
