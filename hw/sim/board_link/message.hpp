// What a simulator and an emulated board in a process of its own say to each other, in lock-step. Both ends
// are built together on one machine: values go as they are in memory.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "common/wire/can_frame.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// The other side is gone, or says what it should not.
struct BoardLinkError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

enum class BusEventKind : std::uint8_t {
    received,   ///< a frame of another controller ended
    started,    ///< this frame, on offer or so a moment ago, is under way
    sent,       ///< and ended
    disturbed,  ///< and was destroyed
};
struct BusEvent {
    BusEventKind kind = BusEventKind::received;
    SimTime time{};
    wire::CanFrame frame{};
};

/// To the board: run until then; this happens on its bus meanwhile, in the order of time.
struct RunUntil {
    SimTime time{};
    std::vector<BusEvent> events;
};
/// To the simulator: done; this is what the CAN controller wants to send next.
struct HasRun {
    std::optional<wire::CanFrame> offer;
};
/// To the simulator, before `HasRun`: what does this sensor see?
struct WhatIsSeen {
    std::uint8_t sensor = 0;
    std::uint32_t ranging_index = 0;
    SimTime window_middle{};
    Roi roi{};
};
struct Seen {
    RangingReturn what;
};
/// To the board: how was it?
struct AskSummary {};
struct BoardSummary {
    std::uint64_t instructions = 0;
    std::uint64_t violations = 0;
    std::array<double, 4> i2c_busy_s{};
    double longest_awake_us = 0.0;
    SimTime counter_zero{};   ///< when the program last set its microsecond counter to 0
    SimTime first_address{};  ///< when the first address of all had passed on an I2C bus; 0: none has
    std::string report;       ///< violations, one a line
};

using BoardMessage = std::variant<RunUntil, HasRun, WhatIsSeen, Seen, AskSummary, BoardSummary>;

[[nodiscard]] std::vector<std::uint8_t> encode_message(const BoardMessage& message);
/// Throws BoardLinkError if it is none.
[[nodiscard]] BoardMessage decode_message(const std::vector<std::uint8_t>& bytes);

}  // namespace octoskin::sim
