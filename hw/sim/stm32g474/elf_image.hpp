// The program to run: an ELF file as the flashing tool would take it, and its symbols for reports.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"

namespace octoskin::sim::stm32 {

struct ElfSegment {
    std::uint32_t physical_address;  ///< where the flashing tool puts it
    std::vector<std::uint8_t> bytes;
};

struct ElfError {
    std::string what;
};

class ElfImage {
  public:
    /// A little-endian 32-bit ARM executable; segments without file contents are left out.
    [[nodiscard]] static Result<ElfImage, ElfError> load(const std::string& path);

    [[nodiscard]] const std::vector<ElfSegment>& segments() const noexcept { return segments_; }
    /// Address of a function (without the Thumb bit) or object.
    [[nodiscard]] std::optional<std::uint32_t> address_of(const std::string& symbol) const;
    /// "function+0x12", or the bare address where no function is known.
    [[nodiscard]] std::string place(std::uint32_t address) const;

  private:
    std::vector<ElfSegment> segments_;
    std::map<std::string, std::uint32_t> symbols_;
    std::map<std::uint32_t, std::string> functions_;
};

}  // namespace octoskin::sim::stm32
