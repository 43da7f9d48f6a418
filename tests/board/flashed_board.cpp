#include "tests/board/flashed_board.hpp"

#include "hw/sim/experiment/board_parts.hpp"

namespace octoskin::sim::stm32 {

NodeConfig fleet(std::uint8_t count, DistanceMode mode, std::uint16_t budget_ms, std::uint16_t period_ms) {
    NodeConfig config{.node_id = 5, .board_type = 1, .sensor_count = count};
    for (std::uint8_t i = 0; i < count; ++i) {
        SensorConfig& sensor = config.sensors.at(i);
        sensor.bus = static_cast<std::uint8_t>(i % 4);
        sensor.xshut_line = i;
        sensor.address = static_cast<std::uint8_t>(0x30 + i);
        sensor.distance_mode = mode;
        sensor.timing_budget_ms = budget_ms;
        sensor.inter_measurement_ms = period_ms;
        sensor.phase_us = static_cast<std::uint16_t>(i * period_ms * 1000 / count);
    }
    return config;
}

FlashedBoard::FlashedBoard(const NodeConfig& config, NucleoOptions options)
    : config_(config), rangings_(config.sensor_count), windows_(config.sensor_count) {
    const BoardParts parts = draw_board_parts({.seed = 3}, config);
    options.bit_rates = {config.nominal_bitrate, config.data_bitrate};
    options.unique_id = parts.unique_id;
    std::array<std::uint8_t, kNodeConfigBytesMax> block{};
    board_ = std::make_unique<NucleoBoard>(options, image::ElfImage::load(OCTOSKIN_FLASHED_IMAGE).value(),
                                           encode(config, block));
    // Each ranging sees another distance, so that no reading can pass for another.
    sensors_ = std::make_unique<SensorCarrier>(
        *board_, config, parts.sensors, [this](std::uint8_t sensor) -> RangingScene {
            return [this, sensor](std::uint32_t index, SimTime middle, const Roi&) {
                rangings_.at(sensor) = index + 1;
                windows_.at(sensor).push_back(middle);
                return RangingReturn{0.2 + 0.001 * (index % 900), 0.002, 20.0, 0.2};
            };
        });
    bus_ = std::make_unique<SimulatedCanBus>(options.bit_rates);
    bus_->tap([this](const wire::CanFrame& frame, SimTime end) { note(frame, end); });
    on_bus_ = std::make_unique<BoardOnBus>(*board_, *bus_);
}

void FlashedBoard::run_for(Microseconds duration) {
    now_.us += duration.count();
    on_bus_->run_until(now_);
}

void FlashedBoard::note(const wire::CanFrame& frame, SimTime end) {
    const auto decoded = wire::decode(frame);
    if (!decoded) return;
    if (const auto* heartbeat = std::get_if<wire::Heartbeat>(&decoded->message))
        heartbeats_.push_back({*heartbeat, end});
    if (const auto* reflex = std::get_if<wire::Reflex>(&decoded->message))
        reflexes_.push_back({*reflex, end});
    if (const auto* info = std::get_if<wire::NodeInfo>(&decoded->message)) {
        if (const auto* traffic = std::get_if<wire::InfoTraffic>(info)) traffic_ = *traffic;
    }
    if (const auto* range = std::get_if<wire::Range>(&decoded->message)) note(range->reading, end);
    if (const auto* range = std::get_if<wire::RangeFd>(&decoded->message)) {
        for (std::uint8_t i = 0; i < range->count; ++i) note(range->entries.at(i).reading, end);
    }
}

void FlashedBoard::note(const wire::RangeReading& reading, SimTime end) {
    if (first_range_.us == 0) first_range_ = end;
    readings_[reading.sensor].push_back({reading, end});
}

std::string FlashedBoard::violations() const {
    std::string text;
    for (const Violation& violation : board_->log().all()) {
        text += std::string(name_of(violation.rule)) + ": " + violation.what + " at " +
                board_->image().place(violation.pc) + "\n";
    }
    return text;
}

}  // namespace octoskin::sim::stm32
