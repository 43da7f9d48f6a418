#include "host/lab/octoskin_board/server.hpp"

namespace octoskin::board {
namespace {

using sim::stm32::NucleoBoard;

void happen(NucleoBoard& board, const sim::BusEvent& event) {
    board.run_until(event.time);
    switch (event.kind) {
        case sim::BusEventKind::received:
            return board.can().on_received(event.frame);
        case sim::BusEventKind::started:
            return board.can().on_started(event.frame);
        case sim::BusEventKind::sent:
            return board.can().on_sent(event.frame);
        case sim::BusEventKind::disturbed:
            return board.can().on_disturbed();
    }
}

sim::SimTime first_address(NucleoBoard& board) {
    std::optional<sim::SimTime> first;
    for (std::size_t bus = 0; bus < NucleoBoard::kI2cBuses; ++bus) {
        const auto time = board.wire(bus).first_address();
        if (time && (!first || *time < *first)) first = time;
    }
    return first.value_or(sim::SimTime{});
}

sim::BoardSummary summary_of(NucleoBoard& board) {
    sim::BoardSummary summary;
    summary.instructions = board.core().instructions();
    summary.violations = board.log().count();
    for (std::size_t bus = 0; bus < NucleoBoard::kI2cBuses; ++bus)
        summary.i2c_busy_s.at(bus) = static_cast<double>(board.i2c_busy_ps(bus)) * 1e-12;
    summary.longest_awake_us = static_cast<double>(board.core().longest_awake_ps()) * 1e-6;
    summary.counter_zero = board.true_time(board.timer2().counter_zero());
    summary.first_address = first_address(board);
    summary.report = violation_report(board);
    return summary;
}

}  // namespace

Bench::SceneOfSensor scene_over(sim::LinkSocket& socket) {
    return [&socket](std::uint8_t sensor) -> sim::RangingScene {
        return [&socket, sensor](std::uint32_t index, sim::SimTime middle, const Roi& roi) {
            socket.send(sim::WhatIsSeen{sensor, index, middle, roi});
            const auto answer = socket.receive();
            const auto* seen = answer ? std::get_if<sim::Seen>(&*answer) : nullptr;
            if (seen == nullptr)
                throw sim::BoardLinkError("board link: no answer to a question for a sensor's view");
            return seen->what;
        };
    };
}

void serve(Bench& bench, sim::LinkSocket& socket) {
    NucleoBoard& board = bench.board();
    std::optional<wire::CanFrame> offer;
    board.on_offer([&offer](const std::optional<wire::CanFrame>& frame) { offer = frame; });
    while (const auto message = socket.receive()) {
        if (const auto* turn = std::get_if<sim::RunUntil>(&*message)) {
            for (const sim::BusEvent& event : turn->events) happen(board, event);
            board.run_until(turn->time);
            socket.send(sim::HasRun{offer});
        } else if (std::holds_alternative<sim::AskSummary>(*message)) {
            socket.send(summary_of(board));
        } else {
            throw sim::BoardLinkError("board link: an unknown command");
        }
    }
}

}  // namespace octoskin::board
