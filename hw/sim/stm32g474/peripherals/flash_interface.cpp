#include "hw/sim/stm32g474/peripherals/flash_interface.hpp"

#include <fmt/format.h>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kAcr = 0x00;
constexpr std::uint32_t kEccr = 0x18;
constexpr std::uint32_t kDoubleError = 1U << 31;      // ECCR.ECCD
constexpr std::uint32_t kErrorFlags = 3U << 30;       // and ECCC: cleared by writing 1
constexpr std::uint32_t kBankBytes = 256 * 1024;      // as delivered: two banks
constexpr std::uint32_t kDebuggerAllowed = 1U << 18;  // ACR.DBG_SWEN
constexpr std::uint32_t kImpossible = 16;

// OPTR as delivered: RDP off, BOR level 0, software watchdog, dual bank, nSWBOOT0 and nBOOT0 set.
constexpr RegisterSpec kRegisters[] = {
    {0x00, "ACR", 0x0004'0601, 0x0004'7F0F},
    {0x04, "PDKEYR", 0, 0},
    {0x08, "KEYR", 0, 0},
    {0x0C, "OPTKEYR", 0, 0},
    {0x10, "SR", 0, 0},
    {0x14, "CR", 0xC000'0000, 0},
    {0x18, "ECCR", 0, 0},
    {0x20, "OPTR", 0xFFEF'F8AA, 0},
};

}  // namespace

std::uint32_t wait_states_needed(std::uint32_t hclk_hz, bool is_range_one, bool is_boosted) {
    if (!is_range_one) return hclk_hz <= 13'000'000 ? 0 : hclk_hz <= 26'000'000 ? 1 : kImpossible;
    const std::uint32_t step = is_boosted ? 34'000'000 : 30'000'000;
    const std::uint32_t states = hclk_hz == 0 ? 0 : (hclk_hz - 1) / step;
    return states <= 4 ? states : kImpossible;
}

FlashInterface::FlashInterface(const Surroundings& surroundings, const Pwr& power)
    : env_(surroundings), power_(power), bank_("FLASH", kRegisters, env_.log) {}

std::uint32_t FlashInterface::read(std::uint32_t offset) {
    return bank_.read(offset);
}

void FlashInterface::write(std::uint32_t offset, std::uint32_t value) {
    if (offset == kEccr) return bank_.clear_bits(kEccr, value & kErrorFlags);
    if (offset != kAcr) {
        env_.log.report(Rule::not_modelled,
                        fmt::format("FLASH: write of 0x{:X} to 0x{:X}: programming", value, offset));
        return;
    }
    if ((value & kDebuggerAllowed) == 0) env_.log.report(Rule::debug_access, "FLASH.ACR: DBG_SWEN cleared");
    bank_.write(offset, value);
    check_latency(hclk_hz_);
}

void FlashInterface::on_double_error(std::uint32_t offset) {
    if ((bank_.get(kEccr) & kDoubleError) != 0) return;
    bank_.set(kEccr, kDoubleError | (offset / kBankBytes) << 21U | (offset % kBankBytes & ~7U));
    env_.lines.pend_nmi();
}

void FlashInterface::check_latency(std::uint32_t hclk_hz) {
    hclk_hz_ = hclk_hz;
    const std::uint32_t needed = wait_states_needed(hclk_hz, power_.is_range_one(), power_.is_boosted());
    const std::uint32_t present = bank_.get(kAcr) & 0xFU;
    if (needed == kImpossible) {
        env_.log.report(Rule::flash_latency,
                        fmt::format("HCLK {} Hz is above what the voltage range and boost allow", hclk_hz));
    } else if (present < needed) {
        env_.log.report(Rule::flash_latency,
                        fmt::format("{} wait states at HCLK {} Hz; {} are needed", present, hclk_hz, needed));
    }
}

}  // namespace octoskin::sim::stm32
