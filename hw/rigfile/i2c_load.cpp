#include "hw/rigfile/i2c_load.hpp"

#include <algorithm>
#include <cmath>

#include "common/range_pause.hpp"

namespace octoskin::rig {
namespace {

constexpr double kSlowestShare = 283.0 / 400.0;

/// Bits on the wire, every byte with its acknowledgement: start, address, 2 index bytes, data, stop.
constexpr unsigned write_bits(unsigned bytes) {
    return 1 + 9 * (1 + 2 + bytes) + 1;
}
/// Start, address, 2 index bytes, repeated start, address, data, stop.
constexpr unsigned read_bits(unsigned bytes) {
    return 1 + 9 * 3 + 1 + 9 * (1 + bytes) + 1;
}

constexpr unsigned kPollBits = read_bits(1);
constexpr unsigned kResultBits = read_bits(17);
constexpr unsigned kClearBits = write_bits(1);
constexpr unsigned kReadBackBits =
    read_bits(1);  ///< one configuration register is read back with every reading
constexpr unsigned kZoneBits = write_bits(1);
static_assert(kPollBits + 2 * kResultBits + kClearBits + kReadBackBits == 518);

/// Greatest difference in the length of ranges, microseconds.
unsigned length_spread_us(const NodeConfig& node) {
    return node.ready_jitter_us - kReadyJitterMinUs;
}

/// If ranges differ in length, a sensor is polled repeatedly until it is ready. The pause between polls is a
/// quarter of the difference, over at most twice the difference; on average polling takes half of that time,
/// and a little more while the node still measures the periods.
unsigned further_polls(const NodeConfig& node) {
    const double spread_us = length_spread_us(node);
    const double poll_us = 1e6 * kPollBits / node.i2c_hz;
    if (spread_us <= 0.0) return 0;
    constexpr double kLearning = 1.0;
    return static_cast<unsigned>(std::ceil(kLearning + spread_us / (poll_us + spread_us / 4.0)));
}

unsigned bits_of_reading(const NodeConfig& node, const SensorConfig& sensor) {
    return kPollBits * (1 + further_polls(node)) + (node.reads_twice ? 2 : 1) * kResultBits + kClearBits +
           kReadBackBits + (sensor.zone_count > 1 ? kZoneBits : 0);
}

}  // namespace

double reading_s(const NodeConfig& node, const SensorConfig& sensor) {
    return bits_of_reading(node, sensor) / (node.i2c_hz * kSlowestShare);
}

Microseconds zone_pause(const NodeConfig& node, const SensorConfig& sensor) {
    constexpr std::int64_t kPeriodOffPermille = 5;  // the node corrects periods that differ by more
    const auto reading = Microseconds{static_cast<std::int64_t>(1e6 * reading_s(node, sensor))};
    const Microseconds period_off{sensor.inter_measurement_ms * kPeriodOffPermille};
    // One range may end late, the next may begin early, and the estimate of either has an error of the same
    // size.
    const Microseconds jitter{3 * length_spread_us(node)};
    return jitter + kRangeOverheadMax + Microseconds{node.zone_guard_us} + kZoneWriteMax + reading +
           period_off;
}

double i2c_load(const NodeConfig& node, std::uint8_t bus) {
    double load = 0.0;
    for (std::size_t i = 0; i < std::min<std::size_t>(node.sensor_count, kNodeSensorsMax); ++i) {
        const SensorConfig& sensor = node.sensors[i];
        if (sensor.bus == bus) load += reading_s(node, sensor) * 1000.0 / sensor.inter_measurement_ms;
    }
    return load;
}

}  // namespace octoskin::rig
