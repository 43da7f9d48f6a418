#include "hw/sim/stm32g474/board_on_bus.hpp"

#include <algorithm>

namespace octoskin::sim::stm32 {

BoardOnBus::BoardOnBus(NucleoBoard& board, SimulatedCanBus& bus) : board_(board), bus_(bus) {
    // The board is first advanced to the instant of the bus event.
    const auto at = [this](SimTime end) -> Fdcan& {
        board_.run_until(end);
        return board_.can();
    };
    seat_ = &bus_.attach_seat(
        {.on_frame = [at](const wire::CanFrame& frame, SimTime end) { at(end).on_received(frame); },
         .on_sent = [at](const wire::CanFrame& frame, SimTime end) { at(end).on_sent(frame); },
         .on_disturbed = [at](const wire::CanFrame&, SimTime end) { at(end).on_disturbed(); }});
    board_.on_offer([this](const std::optional<wire::CanFrame>& frame) { seat_->offer(frame); });
}

void BoardOnBus::run_until(SimTime end, const std::function<void(SimTime now)>& each_turn) {
    while (now_ < end) {
        now_.us = std::min(now_.us + kCanTurnUs, end.us);
        bus_.advance(now_);
        if (const wire::CanFrame* sending = seat_->under_way()) board_.can().on_started(*sending);
        board_.run_until(now_);
        if (each_turn) each_turn(now_);
    }
}

}  // namespace octoskin::sim::stm32
