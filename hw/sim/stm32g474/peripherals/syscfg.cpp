#include "hw/sim/stm32g474/peripherals/syscfg.hpp"

#include <fmt/format.h>

#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kExticr1 = 0x08;
constexpr std::uint32_t kExticr4 = 0x14;
constexpr std::uint32_t kNoPort = 7;  // A to G are 0 to 6

constexpr RegisterSpec kRegisters[] = {
    {0x00, "MEMRMP", 0, 0x107},     {0x04, "CFGR1", 0x7C00'0001, 0xFCFF'0300},
    {0x08, "EXTICR1", 0, 0x7777},   {0x0C, "EXTICR2", 0, 0x7777},
    {0x10, "EXTICR3", 0, 0x7777},   {0x14, "EXTICR4", 0, 0x7777},
    {0x18, "SCSR", 0, 0x1},         {0x1C, "CFGR2", 0, 0x10F},
    {0x20, "SWPR", 0, 0xFFFF'FFFF}, {0x24, "SKR", 0, 0xFF},
};

}  // namespace

Syscfg::Syscfg(const Surroundings& surroundings, std::function<void()> after_change)
    : env_(surroundings), after_change_(std::move(after_change)), bank_("SYSCFG", kRegisters, env_.log) {}

void Syscfg::write(std::uint32_t offset, std::uint32_t value) {
    bank_.write(offset, value);
    if (offset < kExticr1 || offset > kExticr4) return;
    for (std::uint32_t line = (offset - kExticr1); line < offset - kExticr1 + 4; ++line) {
        if (port_of(line) == kNoPort)
            env_.log.report(Rule::wrong_state, fmt::format("SYSCFG: line {} is assigned to no port", line));
    }
    after_change_();
}

std::uint32_t Syscfg::port_of(std::uint32_t line) const {
    return bank_.get(kExticr1 + 4 * (line / 4)) >> (4 * (line % 4)) & 7U;
}

}  // namespace octoskin::sim::stm32
