#include "hw/sim/experiment/emulated_board.hpp"

#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdlib>

namespace octoskin::sim {
namespace {

std::filesystem::path write_block(const NodeConfig& config) {
    std::string name = (std::filesystem::temp_directory_path() / "octoskin-block-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0) throw BoardLinkError(name + ": cannot create a file for the configuration block");
    std::array<std::uint8_t, kNodeConfigBytesMax> bytes{};
    const auto block = encode(config, bytes);
    const bool is_written = write(file, block.data(), block.size()) == static_cast<ssize_t>(block.size());
    close(file);
    if (!is_written) throw BoardLinkError(name + ": cannot write the configuration block");
    return name;
}

/// Text that reads back as the same number.
std::string text_of(double value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.begin(), digits.end(), value);
    return {digits.begin(), end.ptr};
}

std::vector<std::string> arguments_of(const EmulatedBoards& emulated, const std::filesystem::path& block,
                                      double drift_ppm, const PartsReel& reel, std::uint8_t node_id) {
    std::vector<std::string> arguments{"--elf",
                                       emulated.image.string(),
                                       "--config",
                                       block.string(),
                                       "--drift-ppm=" + std::to_string(drift_ppm),
                                       "--seed",
                                       std::to_string(reel.seed),
                                       "--slow-clock-min=" + text_of(reel.slow_clocks.factor_min),
                                       "--slow-clock-max=" + text_of(reel.slow_clocks.factor_max),
                                       "--cycles-per-instruction",
                                       std::to_string(emulated.cycles_per_instruction)};
    for (const TraitsOf& traits : reel.traits) {
        if (traits.node_id.value_or(node_id) == node_id)
            arguments.push_back("--sensor-traits=" + to_text(traits));
    }
    return arguments;
}

}  // namespace

EmulatedBoard::EmulatedBoard(const EmulatedBoards& emulated, const NodeConfig& config, double drift_ppm,
                             const PartsReel& reel, SimulatedCanBus& can, const SceneOfSensor& scene)
    : drift_ppm_(drift_ppm), block_(write_block(config)) {
    for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) scenes_.push_back(scene(sensor));
    process_ = std::make_unique<BoardProcess>(
        emulated.program, arguments_of(emulated, block_, drift_ppm, reel, config.node_id),
        [this](const WhatIsSeen& question) {
            return scenes_.at(question.sensor)(question.ranging_index, question.window_middle, question.roi);
        });
    const auto noting = [this](BusEventKind kind) {
        return [this, kind](const wire::CanFrame& frame, SimTime end) { note(kind, end, frame); };
    };
    seat_ = &can.attach_seat({.on_frame = noting(BusEventKind::received),
                              .on_sent = noting(BusEventKind::sent),
                              .on_disturbed = noting(BusEventKind::disturbed)});
}

EmulatedBoard::~EmulatedBoard() {
    process_.reset();
    std::error_code ignored;  // a leftover file in the temporary directory is harmless
    std::filesystem::remove(block_, ignored);
}

void EmulatedBoard::note(BusEventKind kind, SimTime time, const wire::CanFrame& frame) {
    // A frame may begin and end within one turn: the board must still be notified of its begin.
    if (kind != BusEventKind::received) {
        if (!has_reported_start_) turn_.events.push_back({BusEventKind::started, turn_.time, frame});
        has_reported_start_ = false;
        offered_.reset();
    }
    turn_.events.push_back({kind, time, frame});
}

void EmulatedBoard::begin_turn(SimTime now) {
    if (const wire::CanFrame* sending = seat_->under_way(); sending != nullptr && !has_reported_start_) {
        turn_.events.push_back({BusEventKind::started, now, *sending});
        has_reported_start_ = true;
    }
    turn_.time = now;
    process_->begin(turn_);
    turn_.events.clear();
}

void EmulatedBoard::finish_turn() {
    const HasRun done = process_->finish();
    // A frame on the bus stays on offer until it has ended.
    if (seat_->under_way() != nullptr || done.offer == offered_) return;
    offered_ = done.offer;
    seat_->offer(offered_);
}

const BoardSummary& EmulatedBoard::summary() {
    if (!summary_) summary_ = process_->summary();
    return *summary_;
}

double EmulatedBoard::i2c_busy_s(std::size_t bus) {
    return summary().i2c_busy_s.at(bus);
}

/// The start of the node core is derived from the buses: the first address is sent one turn of the loop after
/// the core's reset time of the sensors.
BoardStart EmulatedBoard::start() {
    constexpr std::int64_t kAddressUs = 28;
    const std::int64_t before_us = (node::Policy{}.xshut_low + kLoopTurn).count() + kAddressUs;
    const SimTime zero = summary().counter_zero;
    const double drifted_us = static_cast<double>(zero.us) * (1.0 + drift_ppm_ * 1e-6);
    const NodeTime at_start = NodeTime{} - Microseconds{static_cast<std::int64_t>(drifted_us)};
    return {.clock = {at_start, drift_ppm_}, .first_turn = {summary().first_address.us - before_us}};
}

std::string EmulatedBoard::violations() {
    return summary().report;
}

}  // namespace octoskin::sim
