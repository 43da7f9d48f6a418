#include "hw/image/elf_image.hpp"

#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "hw/rigfile/file_kind.hpp"

namespace octoskin::image {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kFileBytesMax = std::size_t{64} << 20U;  ///< an image with debug information has 2 MiB
constexpr std::size_t kPieceBytes = std::size_t{1} << 16U;

/// The structure at `offset`; empty if it is not within the file.
template <class T>
std::optional<T> at(Bytes file, std::uint64_t offset) {
    if (offset > file.size() || file.size() - offset < sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, file.data() + offset, sizeof value);
    return value;
}

/// `size` bytes at `offset`; empty if they are not within the file.
std::optional<Bytes> part(Bytes file, std::uint64_t offset, std::uint64_t size) {
    if (offset > file.size() || file.size() - offset < size) return std::nullopt;
    return file.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
}

/// Longest symbol name; longer ones are cut off, against malformed files.
constexpr std::size_t kNameLengthMax = 4096;

/// Most segments, against malformed files: each segment could be as large as the file.
constexpr std::uint32_t kSegmentsMax = 64;

std::string text_at(Bytes file, std::uint64_t offset) {
    if (offset >= file.size()) return {};
    const Bytes rest = file.subspan(static_cast<std::size_t>(offset));
    const Bytes text = rest.first(std::min(rest.size(), kNameLengthMax));
    return {text.begin(), std::find(text.begin(), text.end(), 0)};
}

bool is_arm_executable(const Elf32_Ehdr& header) {
    return std::memcmp(header.e_ident, ELFMAG, SELFMAG) == 0 && header.e_ident[EI_CLASS] == ELFCLASS32 &&
           header.e_ident[EI_DATA] == ELFDATA2LSB && header.e_machine == EM_ARM && header.e_type == ET_EXEC;
}

}  // namespace

Result<ElfImage, Error> ElfImage::load(const std::string& path) {
    if (const auto kind = rig::other_than_a_file(path); !kind.empty())
        return unexpected(Error{.code = ErrorCode::wrong_kind_of_file,
                                .what = fmt::format("is {}, not an ordinary file", kind),
                                .file = path});
    std::ifstream stream(path, std::ios::binary);
    if (!stream)
        return unexpected(Error{.code = ErrorCode::system_error, .what = "cannot be read", .file = path});
    std::vector<std::uint8_t> file;
    std::vector<char> piece(kPieceBytes);
    while (file.size() <= kFileBytesMax) {
        stream.read(piece.data(), kPieceBytes);
        if (stream.gcount() == 0) break;
        file.insert(file.end(), piece.begin(), piece.begin() + stream.gcount());
    }
    if (file.size() > kFileBytesMax) {
        return unexpected(Error{.code = ErrorCode::too_large,
                                .what = fmt::format("over {} bytes, which no image has", kFileBytesMax),
                                .file = path});
    }
    auto image = parse(file);
    if (image) return image;
    Error error = image.error();
    error.file = path;
    return unexpected(std::move(error));
}

Result<ElfImage, Error> ElfImage::parse(Bytes file) {
    const auto header = at<Elf32_Ehdr>(file, 0);
    if (!header || !is_arm_executable(*header)) {
        return unexpected(Error{ErrorCode::foreign_format, "not an executable for 32-bit ARM"});
    }
    if (header->e_phnum > kSegmentsMax) {
        return unexpected(Error{ErrorCode::limit_exceeded,
                                fmt::format("it has {} segments, over {}", header->e_phnum, kSegmentsMax)});
    }
    ElfImage image;
    image.entry_ = header->e_entry;
    if (!image.take_segments(file)) return unexpected(Error{ErrorCode::damaged, "truncated"});
    image.take_sections(file);
    return image;
}

bool ElfImage::take_segments(Bytes file) {
    const auto header = at<Elf32_Ehdr>(file, 0);
    for (std::uint32_t i = 0; i < header->e_phnum; ++i) {
        const auto segment = at<Elf32_Phdr>(file, header->e_phoff + std::uint64_t{i} * header->e_phentsize);
        if (!segment) return false;
        if (segment->p_type != PT_LOAD || segment->p_filesz == 0) continue;
        const auto bytes = part(file, segment->p_offset, segment->p_filesz);
        if (!bytes) return false;
        segments_.push_back({segment->p_paddr, {bytes->begin(), bytes->end()}});
    }
    return true;
}

void ElfImage::take_sections(Bytes file) {
    const auto header = at<Elf32_Ehdr>(file, 0);
    const auto section = [&](std::uint32_t i) {
        return at<Elf32_Shdr>(file, header->e_shoff + std::uint64_t{i} * header->e_shentsize);
    };
    bool has_symbols = false;
    for (std::uint32_t i = 0; i < header->e_shnum; ++i) {
        const auto found = section(i);
        if (found && found->sh_type == SHT_ARM_ATTRIBUTES) {
            const auto bytes = part(file, found->sh_offset, found->sh_size);
            if (bytes) attributes_.assign(bytes->begin(), bytes->end());
        }
        // There is at most one symbol table (System V ABI, "Sections").
        if (!found || found->sh_type != SHT_SYMTAB || has_symbols) continue;
        has_symbols = true;
        const auto names = section(found->sh_link);
        if (names) take_symbols(file, found->sh_offset, found->sh_size, names->sh_offset);
    }
}

void ElfImage::take_symbols(Bytes file, std::uint64_t table, std::uint64_t size, std::uint64_t names) {
    for (std::uint64_t offset = 0; offset + sizeof(Elf32_Sym) <= size; offset += sizeof(Elf32_Sym)) {
        const auto symbol = at<Elf32_Sym>(file, table + offset);
        if (!symbol) return;
        const std::string name = text_at(file, names + symbol->st_name);
        const bool is_function = ELF32_ST_TYPE(symbol->st_info) == STT_FUNC;
        const std::uint32_t address = is_function ? symbol->st_value & ~1U : symbol->st_value;
        if (!name.empty()) symbols_[name] = address;
        if (is_function) functions_[address] = name;
    }
}

std::optional<std::uint32_t> ElfImage::address_of(const std::string& symbol) const {
    const auto found = symbols_.find(symbol);
    if (found == symbols_.end()) return std::nullopt;
    return found->second;
}

std::string ElfImage::place(std::uint32_t address) const {
    const auto after = functions_.upper_bound(address);
    if (after == functions_.begin()) return fmt::format("0x{:08X}", address);
    const auto& [start, name] = *std::prev(after);
    return fmt::format("{}+0x{:X}", name, address - start);
}

}  // namespace octoskin::image
