// An ELF file for the NUCLEO-G474RE, valid or with an intended defect.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octoskin::test {

struct BuiltSegment {
    std::uint32_t type = 1;  ///< PT_LOAD
    std::uint32_t physical_address = 0;
    std::vector<std::uint8_t> bytes;
    std::uint32_t memory_bytes = 0;  ///< more than `bytes`: the rest is cleared by start-up
};

/// The parts of a valid image; a test changes one.
struct ElfBuilder {
    /// A vector table of 118 entries and 64 bytes of code, the last 8 its identity, then 12 bytes of data
    /// that start-up copies to RAM.
    ElfBuilder();

    std::uint32_t entry = 0x0800'01D9;
    std::vector<BuiltSegment> segments;
    std::vector<std::uint8_t> attributes;
    std::uint16_t machine = 40;  ///< EM_ARM
    std::uint16_t type = 2;      ///< ET_EXEC

    /// Entry `index` of the vector table.
    void set_vector(std::uint32_t index, std::uint32_t value);
    /// The layout of the configuration block that it declares; 0: none.
    void set_layout(std::uint16_t layout);
    /// Changes one numeric build attribute.
    void set_attribute(std::uint8_t tag, std::uint8_t value);

    /// The file.
    [[nodiscard]] std::vector<std::uint8_t> bytes() const;
    [[nodiscard]] std::string text() const;
};

}  // namespace octoskin::test
