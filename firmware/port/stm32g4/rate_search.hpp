// Finds the rates of a bus by listening, for a board without a valid configuration block. Such a board must
// report this in its heartbeat and must not disturb the bus.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/time.hpp"
#include "firmware/port/stm32g4/can_bit_timing.hpp"
#include "firmware/port/stm32g4/can_controller.hpp"

namespace octoskin::stm32g4 {

class RateSearch {
  public:
    /// Every host sends SYNC once a second.
    static constexpr Microseconds kPatience{1'500'000};
    /// With this many frames and no error in that time, the rates are those of the bus.
    static constexpr std::uint32_t kFramesMin = 3;

    enum class NextStep : std::uint8_t {
        wait,
        try_next,  ///< listen at the new `rates()`
        found,     ///< join at the current `rates()`
    };

    /// The rates to try now.
    [[nodiscard]] CanRates rates() const noexcept { return kRates[turn_]; }
    void begin(NodeTime now) noexcept { begun_ = now; }

    /// An error ends the try at once. Without errors the try lasts `kPatience`, and then succeeds if at least
    /// `kFramesMin` frames were heard.
    [[nodiscard]] NextStep judge(const Heard& heard, NodeTime now) noexcept {
        const bool is_over = elapsed(begun_, now) >= kPatience;
        if (!heard.has_errors && !is_over) return NextStep::wait;
        if (!heard.has_errors && heard.frames >= kFramesMin) return NextStep::found;
        turn_ = (turn_ + 1) % kRates.size();
        begun_ = now;
        return NextStep::try_next;
    }

  private:
    /// The usual rates of CAN FD. Classical frames are received at any data rate.
    static constexpr std::array<CanRates, 5> kRates = {{{1'000'000, 5'000'000, true},
                                                        {500'000, 2'000'000, true},
                                                        {1'000'000, 2'000'000, true},
                                                        {250'000, 1'000'000, true},
                                                        {125'000, 500'000, true}}};

    std::size_t turn_ = 0;
    NodeTime begun_;
};

}  // namespace octoskin::stm32g4
