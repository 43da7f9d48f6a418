#include "hw/sim/stm32g474/register_bank.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace octoskin::sim::stm32 {

RegisterBank::RegisterBank(std::string_view owner, std::span<const RegisterSpec> specs, ViolationLog& log)
    : owner_(owner), specs_(specs), values_(specs.back().offset / 4 + 1), log_(log) {
    reset();
}

void RegisterBank::reset() {
    for (const RegisterSpec& spec : specs_) values_[spec.offset / 4] = spec.reset;
}

const RegisterSpec* RegisterBank::find(std::uint32_t offset) const {
    const auto found = std::ranges::lower_bound(specs_, offset, {}, &RegisterSpec::offset);
    return found != specs_.end() && found->offset == offset ? &*found : nullptr;
}

std::uint32_t RegisterBank::read(std::uint32_t offset) {
    if (find(offset) == nullptr) {
        log_.report(Rule::not_modelled, fmt::format("{}: read of offset 0x{:X}", owner_, offset));
        return 0;
    }
    return values_[offset / 4];
}

std::uint32_t RegisterBank::checked(std::uint32_t offset, std::uint32_t value) {
    const RegisterSpec* spec = find(offset);
    if (spec == nullptr) {
        log_.report(Rule::not_modelled,
                    fmt::format("{}: write of 0x{:X} to offset 0x{:X}", owner_, value, offset));
        return 0;
    }
    const std::uint32_t present = values_[offset / 4];
    if (spec->writable == 0) {
        log_.report(Rule::read_only, fmt::format("{}.{}: write of 0x{:X}", owner_, spec->name, value));
        return present;
    }
    // A bit that is not writable may be written as it reads (read-modify-write) or as 0.
    const std::uint32_t wrong = value & ~spec->writable & ~present;
    if (wrong != 0) {
        log_.report(Rule::reserved_bits,
                    fmt::format("{}.{}: 0x{:X} sets the reserved or read-only bits 0x{:X}", owner_,
                                spec->name, value, wrong));
    }
    return (value & spec->writable) | (present & ~spec->writable);
}

void RegisterBank::write(std::uint32_t offset, std::uint32_t value) {
    const std::uint32_t stored = checked(offset, value);
    if (find(offset) != nullptr) values_[offset / 4] = stored;
}

std::uint32_t RegisterBank::get(std::uint32_t offset) const {
    return values_.at(offset / 4);
}

void RegisterBank::set(std::uint32_t offset, std::uint32_t value) {
    values_.at(offset / 4) = value;
}

}  // namespace octoskin::sim::stm32
