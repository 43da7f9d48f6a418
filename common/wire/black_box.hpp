// The content of a BLACK_BOX dump, put together from its pieces: a length, a time, and I2C transfers one
// after the other. docs/protocol.md has the byte layout. The node writes dumps; `octoskin black-box` reads
// them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/result.hpp"
#include "common/time.hpp"

namespace octoskin::wire {

enum class TransferOutcome : std::uint8_t {
    done = 0,
    nack_address = 1,
    nack_data = 2,
    timeout = 3,
    arbitration_lost = 4,
    bus_stuck = 5,
};
inline constexpr std::uint8_t kTransferOutcomes = 6;
/// The enumerator as written in the source.
[[nodiscard]] const char* name(TransferOutcome outcome) noexcept;

/// The header of one transfer, before its bytes.
struct TransferHeader {
    NodeTime start;
    std::uint8_t address = 0;  ///< 7 bits
    TransferOutcome outcome = TransferOutcome::done;
    std::uint8_t written = 0;     ///< bytes written
    std::uint8_t read_asked = 0;  ///< bytes requested; none follow if the transfer failed
    [[nodiscard]] constexpr std::size_t bytes_following() const noexcept {
        return std::size_t{written} + (outcome == TransferOutcome::done ? read_asked : 0U);
    }
    friend constexpr bool operator==(const TransferHeader&, const TransferHeader&) = default;
};
inline constexpr std::size_t kTransferHeaderBytes = 8;
[[nodiscard]] std::array<std::uint8_t, kTransferHeaderBytes> encode(const TransferHeader& header) noexcept;

/// The header of a dump, before its transfers.
struct DumpHeader {
    std::uint16_t length = 0;  ///< bytes that follow this field
    NodeTime frozen;           ///< the recording ends here
    friend constexpr bool operator==(const DumpHeader&, const DumpHeader&) = default;
};
inline constexpr std::size_t kDumpHeaderBytes = 6;
[[nodiscard]] std::array<std::uint8_t, kDumpHeaderBytes> encode(const DumpHeader& header) noexcept;

enum class DumpError : std::uint8_t {
    truncated,      ///< ends too early
    invalid_field,  ///< an undefined outcome or address, or a length that does not fit
};
[[nodiscard]] Result<DumpHeader, DumpError> decode_dump_header(std::span<const std::uint8_t> bytes) noexcept;

/// One transfer; the spans refer to the bytes that were decoded.
struct RecordedTransfer {
    TransferHeader header;
    std::span<const std::uint8_t> written;
    std::span<const std::uint8_t> read;
};
/// Removes the first transfer from `bytes`, which must not be empty.
[[nodiscard]] Result<RecordedTransfer, DumpError> take_transfer(
    std::span<const std::uint8_t>& bytes) noexcept;

}  // namespace octoskin::wire
