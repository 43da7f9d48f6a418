#include "hw/sim/stm32g474/elf_image.hpp"

#include <elf.h>
#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <iterator>

namespace octoskin::sim::stm32 {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The structure at `offset`, if it is within the file.
template <class T>
std::optional<T> at(const Bytes& file, std::uint64_t offset) {
    if (offset > file.size() || file.size() - offset < sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, file.data() + offset, sizeof value);
    return value;
}

std::string text_at(const Bytes& file, std::uint64_t offset) {
    std::string text;
    while (offset < file.size() && file[offset] != 0) text.push_back(static_cast<char>(file[offset++]));
    return text;
}

bool is_arm_executable(const Elf32_Ehdr& header) {
    return std::memcmp(header.e_ident, ELFMAG, SELFMAG) == 0 && header.e_ident[EI_CLASS] == ELFCLASS32 &&
           header.e_ident[EI_DATA] == ELFDATA2LSB && header.e_machine == EM_ARM && header.e_type == ET_EXEC;
}

}  // namespace

Result<ElfImage, ElfError> ElfImage::load(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) return unexpected(ElfError{fmt::format("{}: cannot be read", path)});
    const Bytes file{std::istreambuf_iterator<char>(stream), {}};
    const auto header = at<Elf32_Ehdr>(file, 0);
    if (!header || !is_arm_executable(*header)) {
        return unexpected(ElfError{fmt::format("{}: not an executable for 32-bit ARM", path)});
    }
    ElfImage image;
    for (std::uint32_t i = 0; i < header->e_phnum; ++i) {
        const auto segment = at<Elf32_Phdr>(file, header->e_phoff + std::uint64_t{i} * header->e_phentsize);
        if (!segment || (segment->p_type == PT_LOAD &&
                         std::uint64_t{segment->p_offset} + segment->p_filesz > file.size())) {
            return unexpected(ElfError{fmt::format("{}: truncated", path)});
        }
        if (segment->p_type != PT_LOAD || segment->p_filesz == 0) continue;
        const auto first = file.begin() + segment->p_offset;
        image.segments_.push_back({segment->p_paddr, Bytes(first, first + segment->p_filesz)});
    }
    for (std::uint32_t i = 0; i < header->e_shnum; ++i) {
        const auto table = at<Elf32_Shdr>(file, header->e_shoff + std::uint64_t{i} * header->e_shentsize);
        if (!table || table->sh_type != SHT_SYMTAB) continue;
        const auto names =
            at<Elf32_Shdr>(file, header->e_shoff + std::uint64_t{table->sh_link} * header->e_shentsize);
        if (!names) continue;
        for (std::uint64_t offset = 0; offset + sizeof(Elf32_Sym) <= table->sh_size;
             offset += sizeof(Elf32_Sym)) {
            const auto symbol = at<Elf32_Sym>(file, table->sh_offset + offset);
            if (!symbol) break;
            const std::string name = text_at(file, std::uint64_t{names->sh_offset} + symbol->st_name);
            const bool is_function = ELF32_ST_TYPE(symbol->st_info) == STT_FUNC;
            const std::uint32_t address = is_function ? symbol->st_value & ~1U : symbol->st_value;
            if (!name.empty()) image.symbols_[name] = address;
            if (is_function) image.functions_[address] = name;
        }
    }
    return image;
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

}  // namespace octoskin::sim::stm32
