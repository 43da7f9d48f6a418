#include "common/wire/black_box.hpp"

namespace octoskin::wire {
namespace {

constexpr std::uint8_t kAddressMax = 0x7F;
constexpr std::size_t kLengthBytes = 2;

void put(std::uint32_t value, std::span<std::uint8_t> out) {
    for (std::uint8_t& byte : out) {
        byte = static_cast<std::uint8_t>(value);
        value >>= 8U;
    }
}

std::uint32_t number(std::span<const std::uint8_t> bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        value |= std::uint32_t{bytes[i]} << (8 * i);
    }
    return value;
}

}  // namespace

const char* name(TransferOutcome outcome) noexcept {
    switch (outcome) {
        case TransferOutcome::done:
            return "done";
        case TransferOutcome::nack_address:
            return "nack_address";
        case TransferOutcome::nack_data:
            return "nack_data";
        case TransferOutcome::timeout:
            return "timeout";
        case TransferOutcome::arbitration_lost:
            return "arbitration_lost";
        case TransferOutcome::bus_stuck:
            return "bus_stuck";
    }
    return "?";
}

std::array<std::uint8_t, kTransferHeaderBytes> encode(const TransferHeader& header) noexcept {
    std::array<std::uint8_t, kTransferHeaderBytes> bytes{};
    put(header.start.us, std::span(bytes).first(4));
    bytes[4] = header.address;
    bytes[5] = static_cast<std::uint8_t>(header.outcome);
    bytes[6] = header.written;
    bytes[7] = header.read_asked;
    return bytes;
}

std::array<std::uint8_t, kDumpHeaderBytes> encode(const DumpHeader& header) noexcept {
    std::array<std::uint8_t, kDumpHeaderBytes> bytes{};
    put(header.length, std::span(bytes).first(kLengthBytes));
    put(header.frozen.us, std::span(bytes).subspan(kLengthBytes));
    return bytes;
}

Result<DumpHeader, DumpError> decode_dump_header(std::span<const std::uint8_t> bytes) noexcept {
    if (bytes.size() < kDumpHeaderBytes) {
        return unexpected(DumpError::truncated);
    }
    const DumpHeader header{.length = static_cast<std::uint16_t>(number(bytes.first(kLengthBytes))),
                            .frozen = {number(bytes.subspan(kLengthBytes, 4))}};
    if (header.length + kLengthBytes < kDumpHeaderBytes) {
        return unexpected(DumpError::invalid_field);
    }
    return header;
}

Result<RecordedTransfer, DumpError> take_transfer(std::span<const std::uint8_t>& bytes) noexcept {
    if (bytes.size() < kTransferHeaderBytes) {
        return unexpected(DumpError::truncated);
    }
    if (bytes[4] > kAddressMax || bytes[5] >= kTransferOutcomes) {
        return unexpected(DumpError::invalid_field);
    }
    const TransferHeader header{.start = {number(bytes.first(4))},
                                .address = bytes[4],
                                .outcome = static_cast<TransferOutcome>(bytes[5]),
                                .written = bytes[6],
                                .read_asked = bytes[7]};
    const auto rest = bytes.subspan(kTransferHeaderBytes);
    if (rest.size() < header.bytes_following()) {
        return unexpected(DumpError::truncated);
    }
    const std::size_t read = header.bytes_following() - header.written;
    bytes = rest.subspan(header.bytes_following());
    return RecordedTransfer{
        .header = header, .written = rest.first(header.written), .read = rest.subspan(header.written, read)};
}

}  // namespace octoskin::wire
