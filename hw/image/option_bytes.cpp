#include "hw/image/option_bytes.hpp"

#include <fmt/format.h>

#include <array>

namespace octoskin::image {
namespace {

struct Field {
    const char* name;
    std::uint32_t lowest_bit;
    std::uint32_t bits;
    std::uint32_t wanted;
    bool is_written;        ///< by `--write-option-bytes`; the others can change only on an erased chip
    const char* otherwise;  ///< effect on the board of another value

    [[nodiscard]] constexpr std::uint32_t mask() const { return ((1U << bits) - 1U) << lowest_bit; }
    [[nodiscard]] constexpr std::uint32_t value_in(std::uint32_t word) const {
        return (word & mask()) >> lowest_bit;
    }
};

// BOR_LEV 4 is 2.8 V, the highest level: the sensors are specified from 2.6 V, so the controller stops before
// they do. The start from flash is fixed, since BOOT0 is PB8 on the connector and its level could change it.
constexpr auto kFields = std::to_array<Field>({
    {"BOR_LEV", 8, 3, 4, true,
     "a dip of the supply is noticed too late: the sensors fail before the controller resets"},
    {"BFB2", 20, 1, 0, true, "the chip starts from the second bank, where there is no program"},
    {"DBANK", 22, 1, 1, false,
     "pages are 4 KiB, and the configuration shares one with the image (change it on an erased chip only)"},
    {"nSWBOOT0", 26, 1, 0, true,
     "the pin PB8 decides at each reset whether the program starts or ST's loader"},
    {"nBOOT0", 27, 1, 1, true, "without PB8 to decide, the chip starts ST's loader and not the program"},
});

}  // namespace

MaskedWord wanted_option_bytes() {
    MaskedWord wanted;
    for (const Field& field : kFields) {
        if (!field.is_written) continue;
        wanted.mask |= field.mask();
        wanted.value |= field.wanted << field.lowest_bit;
    }
    return wanted;
}

std::string wanted_text() {
    std::string text;
    for (const Field& field : kFields)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", field.name, field.wanted);
    return text;
}

std::string unwritten_text() {
    std::string text;
    for (const Field& field : kFields) {
        if (!field.is_written) text += fmt::format("{}{}", text.empty() ? "" : ", ", field.name);
    }
    return text;
}

std::vector<std::string> option_byte_faults(std::uint32_t flash_optr) {
    std::vector<std::string> faults;
    for (const Field& field : kFields) {
        const std::uint32_t value = field.value_in(flash_optr);
        if (value == field.wanted) continue;
        faults.push_back(
            fmt::format("{} is {}, not {}: {}", field.name, value, field.wanted, field.otherwise));
    }
    return faults;
}

}  // namespace octoskin::image
