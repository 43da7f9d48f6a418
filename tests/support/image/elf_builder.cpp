#include "tests/support/image/elf_builder.hpp"

#include <elf.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "common/config/image_identity.hpp"

namespace octoskin::test {
namespace {

constexpr std::uint32_t kFlash = 0x0800'0000;
constexpr std::uint32_t kVectors = 118;
constexpr std::size_t kCodeBytes = 64;

/// The build attributes of GCC 12.2 for Cortex-M4 with -mfloat-abi=hard -mfpu=fpv4-sp-d16.
const std::vector<std::uint8_t> kAttributes = {
    0x41, 0x31, 0x00, 0x00, 0x00, 0x61, 0x65, 0x61, 0x62, 0x69, 0x00, 0x01, 0x27, 0x00, 0x00, 0x00, 0x05,
    0x37, 0x45, 0x2d, 0x4d, 0x00, 0x06, 0x0d, 0x07, 0x4d, 0x09, 0x02, 0x0a, 0x06, 0x12, 0x04, 0x14, 0x01,
    0x15, 0x01, 0x17, 0x03, 0x18, 0x01, 0x1a, 0x01, 0x1b, 0x01, 0x1c, 0x01, 0x1e, 0x04, 0x22, 0x01};
constexpr std::size_t kFirstNumericTag = 22;  // after the processor's name

template <class T>
void append(std::vector<std::uint8_t>& bytes, const T& value) {
    const auto at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

}  // namespace

ElfBuilder::ElfBuilder() : attributes(kAttributes) {
    BuiltSegment program{.physical_address = kFlash, .bytes = {}};
    program.bytes.resize(kVectors * 4 + kCodeBytes, 0xBF);
    BuiltSegment data{.physical_address = static_cast<std::uint32_t>(kFlash + program.bytes.size()),
                      .bytes = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12},
                      .memory_bytes = 40};
    BuiltSegment stack{.physical_address = 0x2000'0000, .bytes = {}, .memory_bytes = 10240};
    segments = {program, data, stack};
    set_vector(0, 0x2000'2800);
    set_vector(1, entry);
    for (std::uint32_t i = 2; i < kVectors; ++i) set_vector(i, 0x0800'01E1);
    set_layout(kNodeConfigLayout);
}

void ElfBuilder::set_vector(std::uint32_t index, std::uint32_t value) {
    std::memcpy(segments.at(0).bytes.data() + 4 * std::size_t{index}, &value, sizeof value);
}

void ElfBuilder::set_layout(std::uint16_t layout) {
    const auto identity = image_identity(layout);
    std::vector<std::uint8_t>& bytes = segments.at(0).bytes;
    const auto at = bytes.end() - static_cast<std::ptrdiff_t>(identity.size());
    if (layout == 0) {
        std::fill(at, bytes.end(), std::uint8_t{0xBF});
    } else {
        std::copy(identity.begin(), identity.end(), at);
    }
}

void ElfBuilder::set_attribute(std::uint8_t tag, std::uint8_t value) {
    for (std::size_t i = kFirstNumericTag; i + 1 < attributes.size(); i += 2) {
        if (attributes[i] != tag) continue;
        attributes[i + 1] = value;
        return;
    }
    throw std::invalid_argument("no such attribute");
}

std::vector<std::uint8_t> ElfBuilder::bytes() const {
    std::vector<std::uint8_t> contents;
    std::vector<Elf32_Phdr> headers;
    const std::size_t start = sizeof(Elf32_Ehdr) + segments.size() * sizeof(Elf32_Phdr);
    for (const BuiltSegment& segment : segments) {
        Elf32_Phdr header{};
        header.p_type = segment.type;
        header.p_offset = static_cast<Elf32_Off>(start + contents.size());
        header.p_paddr = segment.physical_address;
        header.p_vaddr = segment.physical_address;
        header.p_filesz = static_cast<Elf32_Word>(segment.bytes.size());
        header.p_memsz = std::max(header.p_filesz, segment.memory_bytes);
        headers.push_back(header);
        contents.insert(contents.end(), segment.bytes.begin(), segment.bytes.end());
    }
    const std::size_t attributes_at = start + contents.size();
    contents.insert(contents.end(), attributes.begin(), attributes.end());

    Elf32_Ehdr header{};
    std::memcpy(header.e_ident, ELFMAG, SELFMAG);
    header.e_ident[EI_CLASS] = ELFCLASS32;
    header.e_ident[EI_DATA] = ELFDATA2LSB;
    header.e_ident[EI_VERSION] = EV_CURRENT;
    header.e_type = type;
    header.e_machine = machine;
    header.e_version = EV_CURRENT;
    header.e_entry = entry;
    header.e_ehsize = sizeof header;
    header.e_phoff = sizeof header;
    header.e_phentsize = sizeof(Elf32_Phdr);
    header.e_phnum = static_cast<Elf32_Half>(segments.size());
    header.e_shoff = static_cast<Elf32_Off>(start + contents.size());
    header.e_shentsize = sizeof(Elf32_Shdr);
    header.e_shnum = attributes.empty() ? 1 : 2;

    std::vector<std::uint8_t> file;
    append(file, header);
    for (const Elf32_Phdr& each : headers) append(file, each);
    file.insert(file.end(), contents.begin(), contents.end());
    append(file, Elf32_Shdr{});
    if (!attributes.empty()) {
        Elf32_Shdr section{};
        section.sh_type = SHT_ARM_ATTRIBUTES;
        section.sh_offset = static_cast<Elf32_Off>(attributes_at);
        section.sh_size = static_cast<Elf32_Word>(attributes.size());
        append(file, section);
    }
    return file;
}

std::string ElfBuilder::text() const {
    const auto file = bytes();
    return {file.begin(), file.end()};
}

}  // namespace octoskin::test
