#include "hw/image/image_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "common/config/image_identity.hpp"
#include "hw/image/build_attributes.hpp"

namespace octoskin::image {
namespace {

using Faults = std::vector<std::string>;

/// Vectors that may be 0, since they are reserved: 7 to 10 and 13 of the core, and interrupt 85.
constexpr std::array<std::uint32_t, 6> kReservedVectors = {7, 8, 9, 10, 13, 16 + 85};

/// The word at an address; empty unless one segment contains all four bytes.
std::optional<std::uint32_t> word_at(const ElfImage& image, std::uint32_t address) {
    for (const ElfSegment& segment : image.segments()) {
        if (address < segment.physical_address) continue;
        const std::size_t offset = address - segment.physical_address;
        if (offset >= segment.bytes.size() || segment.bytes.size() - offset < 4) continue;
        std::uint32_t word = 0;
        for (std::size_t i = 0; i < 4; ++i) word |= std::uint32_t{segment.bytes[offset + i]} << (8 * i);
        return word;
    }
    return std::nullopt;
}

bool is_thumb_code(const ElfImage& image, std::uint32_t vector) {
    if ((vector & 1U) == 0) return false;
    return std::any_of(image.segments().begin(), image.segments().end(), [vector](const ElfSegment& segment) {
        const std::uint64_t end = std::uint64_t{segment.physical_address} + segment.bytes.size();
        return vector - 1 >= segment.physical_address && std::uint64_t{vector} + 1 <= end;
    });
}

void check_places(const ElfImage& image, const rig::BoardHardware& board, Faults& faults) {
    if (image.segments().empty()) faults.push_back("it has nothing to program");
    const ElfSegment* before = nullptr;
    std::vector<const ElfSegment*> ordered;
    for (const ElfSegment& segment : image.segments()) ordered.push_back(&segment);
    std::sort(ordered.begin(), ordered.end(), [](const ElfSegment* a, const ElfSegment* b) {
        return a->physical_address < b->physical_address;
    });
    for (const ElfSegment* segment : ordered) {
        const std::uint64_t first = segment->physical_address;
        const std::uint64_t end = first + segment->bytes.size();
        if (!board.flash.contains(first, segment->bytes.size())) {
            faults.push_back(fmt::format("{} bytes at 0x{:08X} are outside flash (0x{:08X} to 0x{:08X})",
                                         segment->bytes.size(), first, board.flash.address,
                                         board.flash.end() - 1));
        } else if (end > board.configuration_page.address) {
            faults.push_back(fmt::format("{} bytes at 0x{:08X} reach into the configuration page at 0x{:08X}",
                                         segment->bytes.size(), first, board.configuration_page.address));
        }
        if (before != nullptr && std::uint64_t{before->physical_address} + before->bytes.size() > first) {
            faults.push_back(fmt::format("two segments overlap at 0x{:08X}", first));
        }
        before = segment;
    }
}

void check_start(const ElfImage& image, const rig::BoardHardware& board, Faults& faults) {
    const auto stack = word_at(image, board.flash.address);
    const auto reset = word_at(image, board.flash.address + 4);
    if (!stack || !reset) {
        faults.push_back(fmt::format("there is no vector table at 0x{:08X}", board.flash.address));
        return;
    }
    if (*stack <= board.ram.address || *stack > board.ram.end()) {
        faults.push_back(
            fmt::format("the initial stack pointer 0x{:08X} is outside RAM (0x{:08X} to 0x{:08X})", *stack,
                        board.ram.address, board.ram.end()));
    }
    if (*stack % 8 != 0)
        faults.push_back(fmt::format("the initial stack pointer 0x{:08X} is not a multiple of 8", *stack));
    if (*reset != image.entry()) {
        faults.push_back(
            fmt::format("the reset vector 0x{:08X} is not the entry 0x{:08X}", *reset, image.entry()));
    }
}

void check_vectors(const ElfImage& image, const rig::BoardHardware& board, Faults& faults) {
    for (std::uint32_t i = 1; i < board.vector_count; ++i) {
        const auto vector = word_at(image, board.flash.address + 4 * i);
        if (!vector) {
            faults.push_back(
                fmt::format("the vector table ends before entry {} of {}", i, board.vector_count));
            return;
        }
        const bool is_reserved =
            std::find(kReservedVectors.begin(), kReservedVectors.end(), i) != kReservedVectors.end();
        if ((is_reserved && *vector == 0) || is_thumb_code(image, *vector)) continue;
        faults.push_back(fmt::format("vector {} is 0x{:08X}: not Thumb code in this image", i, *vector));
    }
}

void check_target(const ElfImage& image, Faults& faults) {
    const auto attributes = build_attributes(image.attributes());
    if (!attributes) {
        faults.push_back("its target is unknown: it has no ARM build attributes");
        return;
    }
    const auto expect = [&](BuildTag tag, std::uint32_t wanted, const char* what) {
        const auto found = attributes->find(static_cast<std::uint32_t>(tag));
        const std::uint32_t value = found == attributes->end() ? 0 : found->second;
        if (value == wanted) return;
        faults.push_back(fmt::format("it is not compiled {}: build attribute {} is {}, expected {}", what,
                                     static_cast<std::uint32_t>(tag), value, wanted));
    };
    expect(BuildTag::cpu_architecture, kArchitectureV7eM, "for ARMv7E-M");
    expect(BuildTag::fp_architecture, kFpV4D16, "for FPv4-D16");
    expect(BuildTag::fp_use, kSinglePrecisionOnly, "for single precision only");
    expect(BuildTag::vfp_arguments, kArgumentsInVfpRegisters, "with arguments in floating-point registers");
}

/// The layout of configuration block that the image reads, from its identity; empty if it has none.
std::optional<std::uint16_t> layout_of(const ElfImage& image) {
    for (const ElfSegment& segment : image.segments()) {
        auto from = segment.bytes.begin();
        while (true) {  // each iteration checks one occurrence of the magic
            from = std::search(from, segment.bytes.end(), kImageIdentityMagic.begin(),
                               kImageIdentityMagic.end());
            if (segment.bytes.end() - from < static_cast<std::ptrdiff_t>(kImageIdentityBytes)) break;
            const auto layout = static_cast<std::uint16_t>(from[4] | from[5] << 8);
            const auto whole = image_identity(layout);
            if (std::equal(whole.begin(), whole.end(), from)) return layout;
            ++from;
        }
    }
    return std::nullopt;
}

void check_layout(const ElfImage& image, Faults& faults) {
    const auto layout = layout_of(image);
    if (!layout) {
        faults.push_back(
            "its layout of configuration block is unknown: it is not an image of octoskin, or an "
            "old one");
    } else if (*layout != kNodeConfigLayout) {
        faults.push_back(
            fmt::format("it reads configuration blocks of layout {}, but this octoskin writes layout {}: "
                        "build both from the same commit (firmware/flash does)",
                        *layout, kNodeConfigLayout));
    }
}

}  // namespace

std::vector<std::string> faults_of(const ElfImage& image, const rig::BoardHardware& board) {
    Faults faults;
    check_places(image, board, faults);
    check_start(image, board, faults);
    check_vectors(image, board, faults);
    check_target(image, faults);
    check_layout(image, faults);
    return faults;
}

}  // namespace octoskin::image
