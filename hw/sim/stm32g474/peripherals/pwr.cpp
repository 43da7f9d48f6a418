#include "hw/sim/stm32g474/peripherals/pwr.hpp"

#include <utility>

namespace octoskin::sim::stm32 {
namespace {

// Pull registers 0x20..0x54 belong to Standby, which is not modelled.
constexpr RegisterSpec kRegisters[] = {
    {0x00, "CR1", 0x0000'0200, 0x0000'470F},
    {0x04, "CR2", 0, 0x0000'00CF},
    {0x08, "CR3", 0x0000'8000, 0x0000'E51F},
    {0x0C, "CR4", 0, 0x0000'031F},
    {0x10, "SR1", 0, 0},
    {0x14, "SR2", 0, 0},
    {0x18, "SCR", 0, 0x0000'011F},
    {0x80, "CR5", 0x0000'0100, 0x0000'0100},
};
constexpr std::uint32_t kVos = 3U << 9;  // CR1, missing in ST's register description

constexpr std::uint32_t writable_with_vos(std::uint32_t value) {
    return value & ~kVos;
}

}  // namespace

Pwr::Pwr(const Surroundings& surroundings, std::function<void()> after_change)
    : env_(surroundings), after_change_(std::move(after_change)), bank_("PWR", kRegisters, env_.log) {}

void Pwr::write(std::uint32_t offset, std::uint32_t value) {
    if (offset != 0x00) {
        bank_.write(offset, value);
    } else {
        const std::uint32_t vos = value & kVos;
        const std::uint32_t rest = bank_.checked(0x00, writable_with_vos(value)) & ~kVos;
        if (vos == 0 || vos == kVos) env_.log.report(Rule::wrong_state, "PWR.CR1.VOS: only 1 and 2 exist");
        bank_.set(0x00, rest | vos);
    }
    after_change_();
}

}  // namespace octoskin::sim::stm32
