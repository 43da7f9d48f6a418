// A CAN frame from anybody: what decodes encodes to the same frame again. Input: flags, identifier (2 bytes),
// payload. The flags may ask for a correct checksum, without which hardly an input would get past it.
#include <algorithm>
#include <cassert>

#include "common/wire/codec.hpp"
#include "common/wire/crc.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin {
namespace {

using wire::CanFrame;

constexpr unsigned kExtended = 1, kRemote = 2, kError = 4, kFd = 8, kSealCrc8 = 16, kSealCrc16 = 32;

CanFrame frame_of(std::span<const std::uint8_t> input) {
    CanFrame frame;
    const unsigned flags = input[0];
    frame.is_extended = (flags & kExtended) != 0;
    frame.is_remote = (flags & kRemote) != 0;
    frame.is_error = (flags & kError) != 0;
    frame.is_fd = (flags & kFd) != 0;
    frame.can_id = input[1] | static_cast<std::uint32_t>(input[2]) << 8U;
    const auto payload = input.subspan(3);
    // A length beyond the array is what a careless adapter could hand over.
    frame.payload_len = static_cast<std::uint8_t>(std::min<std::size_t>(payload.size(), 255));
    std::copy_n(payload.begin(), std::min(payload.size(), frame.data.size()), frame.data.begin());
    return frame;
}

/// The checksum covers identifier, length and data (docs/protocol.md).
void seal(CanFrame& frame, unsigned flags) {
    const std::uint8_t head[] = {static_cast<std::uint8_t>(frame.can_id),
                                 static_cast<std::uint8_t>(frame.can_id >> 8U), frame.payload_len};
    if (frame.payload_len < 2 || frame.payload_len > wire::kFdPayloadMax) return;
    const auto payload = std::span(frame.data).first(frame.payload_len);
    if ((flags & kSealCrc8) != 0) {
        payload.back() = crc8(payload.first(payload.size() - 1), crc8(head));
    } else if ((flags & kSealCrc16) != 0) {
        const std::uint16_t crc = crc16(payload.first(payload.size() - 2), crc16(head));
        payload[payload.size() - 2] = static_cast<std::uint8_t>(crc >> 8U);
        payload.back() = static_cast<std::uint8_t>(crc);
    }
}

void check(const CanFrame& frame) {
    const auto decoded = wire::decode(frame);
    if (!decoded) {
        assert(static_cast<std::size_t>(decoded.error()) < wire::kDecodeErrors);
        return;
    }
    CanFrame again = wire::encode(decoded->message, decoded->node_id);
    again.has_bit_rate_switch = frame.has_bit_rate_switch;  // makes no difference to a receiver
    assert(again == frame);
}

}  // namespace
}  // namespace octoskin

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 3) return 0;
    octoskin::wire::CanFrame frame = octoskin::frame_of({data, size});
    octoskin::seal(frame, data[0]);
    octoskin::check(frame);
    return 0;
}
