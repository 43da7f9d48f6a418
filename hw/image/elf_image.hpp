// The program for a board: the segments, build attributes and symbols of an ELF file.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/errors/error.hpp"

namespace octoskin::image {

struct ElfSegment {
    std::uint32_t physical_address;  ///< address for the flashing tool
    std::vector<std::uint8_t> bytes;
};

class ElfImage {
  public:
    /// Loads a little-endian 32-bit ARM executable; segments without file contents are left out. Errors: the
    /// file cannot be read, or has over 64 MiB, and those of `parse`. The error has the path.
    [[nodiscard]] static Result<ElfImage, Error> load(const std::string& path);
    /// `file`: the whole ELF file. Errors: not such an executable; over 64 segments; a header or a segment
    /// extends past the end.
    [[nodiscard]] static Result<ElfImage, Error> parse(std::span<const std::uint8_t> file);

    [[nodiscard]] const std::vector<ElfSegment>& segments() const noexcept { return segments_; }
    /// Entry address, including the Thumb bit.
    [[nodiscard]] std::uint32_t entry() const noexcept { return entry_; }
    /// The contents of `.ARM.attributes`, for `build_attributes`; empty if there are none.
    [[nodiscard]] std::span<const std::uint8_t> attributes() const noexcept { return attributes_; }
    /// Address of a function (without the Thumb bit) or object; empty if there is no such symbol.
    [[nodiscard]] std::optional<std::uint32_t> address_of(const std::string& symbol) const;
    /// "function+0x12", or the bare address if it precedes every known function.
    [[nodiscard]] std::string place(std::uint32_t address) const;

  private:
    using Bytes = std::span<const std::uint8_t>;
    [[nodiscard]] bool take_segments(Bytes file);
    void take_sections(Bytes file);
    void take_symbols(Bytes file, std::uint64_t table, std::uint64_t size, std::uint64_t names);

    std::uint32_t entry_ = 0;
    std::vector<ElfSegment> segments_;
    std::vector<std::uint8_t> attributes_;
    std::map<std::string, std::uint32_t> symbols_;
    std::map<std::uint32_t, std::string> functions_;
};

}  // namespace octoskin::image
