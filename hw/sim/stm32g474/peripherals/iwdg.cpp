#include "hw/sim/stm32g474/peripherals/iwdg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kKr = 0x00;
constexpr std::uint32_t kPr = 0x04;
constexpr std::uint32_t kRlr = 0x08;
constexpr std::uint32_t kSr = 0x0C;
constexpr std::uint32_t kWinr = 0x10;
constexpr std::uint32_t kRefresh = 0xAAAA;
constexpr std::uint32_t kUnlock = 0x5555;
constexpr std::uint32_t kStart = 0xCCCC;
constexpr std::uint32_t kTransferClocks = 5;  // RM0440 42.4.4: up to five periods of the slow clock

constexpr RegisterSpec kRegisters[] = {
    {0x00, "KR", 0, 0xFFFF}, {0x04, "PR", 0, 0x7},         {0x08, "RLR", 0xFFF, 0xFFF},
    {0x0C, "SR", 0, 0},      {0x10, "WINR", 0xFFF, 0xFFF},
};

}  // namespace

Iwdg::Iwdg(const Surroundings& surroundings, std::uint32_t lsi_hz, std::function<void()> bite)
    : env_(surroundings), lsi_hz_(lsi_hz), bite_(std::move(bite)), bank_("IWDG", kRegisters, env_.log) {}

void Iwdg::reset() {
    bank_.reset();
    is_running_ = is_unlocked_ = false;
    prescaler_ = 0;
    reload_ = 0xFFF;
    prescaler_arrives_ = reload_arrives_ = window_arrives_ = bites_at_ = kNever;
}

std::int64_t Iwdg::period() const {
    const std::uint64_t divider = std::min<std::uint64_t>(4ULL << prescaler_, 256);
    return span_of((std::uint64_t{reload_} + 1) * divider, lsi_hz_);
}

void Iwdg::reload() {
    bites_at_ = env_.now + period();
}

void Iwdg::advance() {
    if (env_.now >= prescaler_arrives_) {
        prescaler_arrives_ = kNever;
        prescaler_ = bank_.get(kPr);
        bank_.clear_bits(kSr, 1);
        if (is_running_) reload();  // the count so far is small relative to the first period
    }
    if (env_.now >= reload_arrives_) {
        reload_arrives_ = kNever;
        reload_ = bank_.get(kRlr);
        bank_.clear_bits(kSr, 2);
    }
    if (env_.now >= window_arrives_) {
        window_arrives_ = kNever;
        bank_.clear_bits(kSr, 4);
    }
    if (is_running_ && env_.now >= bites_at_) {
        bites_at_ = kNever;
        bite_();
    }
}

BoardTime Iwdg::next_event() const {
    return std::min({prescaler_arrives_, reload_arrives_, window_arrives_, bites_at_});
}

std::uint32_t Iwdg::read(std::uint32_t offset) {
    return offset == kKr ? 0 : bank_.read(offset);
}

void Iwdg::write_key(std::uint32_t value) {
    is_unlocked_ = value == kUnlock;
    if (value == kStart && !is_running_) {
        is_running_ = true;
        reload();
    } else if (value == kRefresh && is_running_) {
        reload();
    } else if (value != kStart && value != kRefresh && value != kUnlock) {
        env_.log.report(Rule::wrong_state, fmt::format("IWDG.KR=0x{:X} is no key", value));
    }
}

void Iwdg::write(std::uint32_t offset, std::uint32_t value) {
    if (offset == kKr) return write_key(value);
    const std::uint32_t busy = offset == kPr ? 1U : offset == kRlr ? 2U : 4U;
    if (!is_unlocked_) {
        env_.log.report(Rule::wrong_state, fmt::format("IWDG: offset 0x{:X} written while locked", offset));
        return;
    }
    if ((bank_.get(kSr) & busy) != 0) {
        env_.log.report(Rule::wrong_state,
                        fmt::format("IWDG: offset 0x{:X} written while it is updated", offset));
        return;
    }
    bank_.write(offset, value);
    const BoardTime arrival = env_.now + span_of(kTransferClocks, lsi_hz_);
    if (offset == kPr) prescaler_arrives_ = arrival;
    if (offset == kRlr) reload_arrives_ = arrival;
    if (offset == kWinr) {
        env_.log.report(Rule::not_modelled, "IWDG.WINR: the window");
        window_arrives_ = arrival;
    }
    if (offset == kPr || offset == kRlr || offset == kWinr) bank_.set_bits(kSr, busy);
}

}  // namespace octoskin::sim::stm32
