// Messages between a simulator and an emulated board in a separate process, in lock-step. Both ends are of
// one build on one machine: values are sent as in memory.
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

/// The other side closed the socket, or sent an unexpected message.
struct BoardLinkError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

enum class BusEventKind : std::uint8_t {
    received,   ///< a frame of another controller ended
    started,    ///< this frame, on offer now or until just before, is being sent
    sent,       ///< the frame ended
    disturbed,  ///< the frame was destroyed
};
struct BusEvent {
    BusEventKind kind = BusEventKind::received;
    SimTime time{};
    wire::CanFrame frame{};
};

/// To the board: run until `time`; contains the events on its bus until then, in the order of time.
struct RunUntil {
    SimTime time{};
    std::vector<BusEvent> events;
};
/// To the simulator: the turn is done; contains the frame that the CAN controller offers next.
struct HasRun {
    std::optional<wire::CanFrame> offer;
};
/// To the simulator, before `HasRun`: asks for the view of a sensor.
struct WhatIsSeen {
    std::uint8_t sensor = 0;
    std::uint32_t ranging_index = 0;
    SimTime window_middle{};
    Roi roi{};
};
struct Seen {
    RangingReturn what;
};
/// To the board: asks for the summary of the run.
struct AskSummary {};
struct BoardSummary {
    std::uint64_t instructions = 0;
    std::uint64_t violations = 0;
    std::array<double, 4> i2c_busy_s{};
    double longest_awake_us = 0.0;
    SimTime counter_zero{};   ///< when the program last set its microsecond counter to 0
    SimTime first_address{};  ///< end of the first address on any I2C bus; 0: none yet
    std::string report;       ///< violations, one a line
};

using BoardMessage = std::variant<RunUntil, HasRun, WhatIsSeen, Seen, AskSummary, BoardSummary>;

[[nodiscard]] std::vector<std::uint8_t> encode_message(const BoardMessage& message);
/// Throws BoardLinkError if the bytes are not a message.
[[nodiscard]] BoardMessage decode_message(const std::vector<std::uint8_t>& bytes);

}  // namespace octoskin::sim
