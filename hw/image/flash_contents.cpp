#include "hw/image/flash_contents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

namespace octoskin::image {
namespace {

constexpr std::uint8_t kErased = 0xFF;
constexpr std::size_t kFlashUnitBytes = 8;  // RM0440: flash is programmed in double words
constexpr std::size_t kBytesPerRecord = 16;

enum class HexRecord : std::uint8_t { data = 0, end_of_file = 1, extended_linear_address = 4 };

void append_record(std::string& text, HexRecord kind, std::uint16_t address,
                   std::span<const std::uint8_t> bytes) {
    const std::array<std::uint8_t, 4> head = {
        static_cast<std::uint8_t>(bytes.size()), static_cast<std::uint8_t>(address >> 8U),
        static_cast<std::uint8_t>(address & 0xFFU), static_cast<std::uint8_t>(kind)};
    std::uint32_t sum = 0;
    const auto append = [&](std::uint8_t byte) {
        fmt::format_to(std::back_inserter(text), "{:02X}", byte);
        sum += byte;
    };
    text += ':';
    for (const std::uint8_t byte : head) append(byte);
    for (const std::uint8_t byte : bytes) append(byte);
    append(static_cast<std::uint8_t>(0x100U - (sum & 0xFFU)));
    text += '\n';
}

void append_part(std::string& text, const FlashPart& part) {
    for (std::size_t at = 0; at < part.bytes.size();) {
        const auto address = static_cast<std::uint32_t>(part.address + at);
        if (at == 0 || (address & 0xFFFFU) == 0) {
            const std::array<std::uint8_t, 2> upper = {static_cast<std::uint8_t>(address >> 24U),
                                                       static_cast<std::uint8_t>(address >> 16U & 0xFFU)};
            append_record(text, HexRecord::extended_linear_address, 0, upper);
        }
        // No record crosses a 64 KiB boundary, where the upper half of the address changes.
        const std::size_t to_line = 0x1'0000U - (address & 0xFFFFU);
        const std::size_t count = std::min({kBytesPerRecord, part.bytes.size() - at, to_line});
        append_record(text, HexRecord::data, static_cast<std::uint16_t>(address & 0xFFFFU),
                      std::span(part.bytes).subspan(at, count));
        at += count;
    }
}

void fill_up(std::vector<std::uint8_t>& bytes) {
    bytes.resize((bytes.size() + kFlashUnitBytes - 1) / kFlashUnitBytes * kFlashUnitBytes, kErased);
}

}  // namespace

std::vector<std::uint8_t> binary(const ElfImage& image, const rig::BoardHardware& board) {
    std::vector<std::uint8_t> bytes;
    for (const ElfSegment& segment : image.segments()) {
        const std::size_t offset = segment.physical_address - board.flash.address;
        bytes.resize(std::max(bytes.size(), offset + segment.bytes.size()), kErased);
        std::copy(segment.bytes.begin(), segment.bytes.end(),
                  bytes.begin() + static_cast<std::ptrdiff_t>(offset));
    }
    return bytes;
}

FlashContents merge(const ElfImage& image, const NodeConfig& config, const rig::BoardHardware& board) {
    FlashContents contents{{board.flash.address, binary(image, board)}};
    std::array<std::uint8_t, kNodeConfigBytesMax> page{};
    const auto block = encode(config, page);
    contents.push_back({board.configuration_page.address, {block.begin(), block.end()}});
    for (FlashPart& part : contents) fill_up(part.bytes);
    return contents;
}

std::string intel_hex(const FlashContents& contents) {
    std::string text;
    for (const FlashPart& part : contents) append_part(text, part);
    append_record(text, HexRecord::end_of_file, 0, {});
    return text;
}

}  // namespace octoskin::image
