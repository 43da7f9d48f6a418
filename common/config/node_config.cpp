#include "common/config/node_config.hpp"

#include <cassert>
#include <concepts>
#include <type_traits>

#include "common/config/image_identity.hpp"
#include "common/config/verified_registers.hpp"
#include "common/wire/crc.hpp"

namespace octoskin {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t kMagic = 0x434B534F;  // "OSKC" in memory
/// Without the fields that layout 5 added.
constexpr std::uint16_t kPlainLayout = 4;
static_assert(kNodeConfigLayout == kPlainLayout + 1);
constexpr std::size_t kHeaderBytes = 8;
constexpr std::size_t kCrcBytes = 4;

/// Appends integers, least significant byte first.
class ByteWriter {
  public:
    static constexpr bool kFillsIn = false;
    explicit ByteWriter(std::span<std::uint8_t> out) : out_(out) {}

    template <std::integral T>
    void number(const T& value) {
        auto rest = static_cast<std::make_unsigned_t<T>>(value);
        for (std::size_t i = 0; i < sizeof(T); ++i) {
            assert(used_ < out_.size());
            out_[used_++] = static_cast<std::uint8_t>(rest);
            rest = static_cast<std::make_unsigned_t<T>>(std::uint64_t{rest} >> 8U);
        }
    }
    void flag(const bool& value) { number(static_cast<std::uint8_t>(value)); }
    template <class E>
    void choice(const E& value) {
        number(static_cast<std::uint8_t>(value));
    }
    void count(const std::uint8_t& value, std::size_t most) {
        assert(value <= most);
        number(value);
    }
    [[nodiscard]] std::size_t used() const { return used_; }

  private:
    std::span<std::uint8_t> out_;
    std::size_t used_ = 0;
};

/// Takes integers from the front. Past the end it returns zeros and records the failure.
class ByteReader {
  public:
    static constexpr bool kFillsIn = true;
    explicit ByteReader(Bytes bytes) : bytes_(bytes) {}

    template <std::integral T>
    void number(T& value) {
        if (bytes_.size() < sizeof(T)) {
            has_failed_ = true;
            bytes_ = {};
            value = 0;
            return;
        }
        std::uint64_t sum = 0;
        for (std::size_t i = 0; i < sizeof(T); ++i) {
            sum |= std::uint64_t{bytes_[i]} << (8 * i);
        }
        value = static_cast<T>(sum);
        bytes_ = bytes_.subspan(sizeof(T));
    }
    void flag(bool& value) {
        std::uint8_t raw = 0;
        number(raw);
        has_failed_ |= raw > 1;
        value = raw == 1;
    }
    template <class E>
    void choice(E& value) {
        std::uint8_t raw = 0;
        number(raw);
        value = static_cast<E>(raw);
    }
    void count(std::uint8_t& value, std::size_t most) {
        number(value);
        if (value > most) {
            has_failed_ = true;
            value = 0;
        }
    }
    [[nodiscard]] bool has_failed() const { return has_failed_; }
    [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

  private:
    Bytes bytes_;
    bool has_failed_ = false;
};

template <class Walker, class T>
using Of = std::conditional_t<Walker::kFillsIn, T, const T>;

// The layout, written once for both directions.
template <class Walker>
void walk(Walker& walker, Of<Walker, SensorConfig>& sensor) {
    walker.number(sensor.bus);
    walker.number(sensor.xshut_line);
    walker.number(sensor.address);
    walker.choice(sensor.distance_mode);
    walker.number(sensor.timing_budget_ms);
    walker.number(sensor.inter_measurement_ms);
    walker.number(sensor.phase_us);
    walker.number(sensor.offset_quarter_mm);
    walker.flag(sensor.has_offset);
    walker.number(sensor.crosstalk_raw);
    walker.number(sensor.sigma_limit_quarter_mm);
    walker.number(sensor.signal_limit_raw);
    walker.number(sensor.reflex_below_mm);
    walker.flag(sensor.applies_gain_factor);
    walker.count(sensor.zone_count, kSensorZonesMax);
    for (std::size_t i = 0; i < sensor.zone_count; ++i) {
        walker.number(sensor.zones[i].centre_spad);
        walker.number(sensor.zones[i].width);
        walker.number(sensor.zones[i].height);
    }
}

template <class Walker>
void walk(Walker& walker, Of<Walker, NodeConfig>& config) {
    walker.number(config.node_id);
    walker.number(config.board_type);
    walker.flag(config.uses_can_fd);
    walker.number(config.nominal_bitrate);
    walker.number(config.data_bitrate);
    walker.number(config.i2c_hz);
    walker.flag(config.is_io_2v8);
    walker.flag(config.reads_twice);
    walker.choice(config.stream_gate);
    walker.number(config.aux_every);
    walker.number(config.zone_guard_us);
    walker.flag(config.holds_phases);
    walker.number(config.data_ready_buses);
    walker.count(config.sensor_count, kNodeSensorsMax);
    for (std::size_t i = 0; i < config.sensor_count; ++i) {
        walk(walker, config.sensors[i]);
    }
}

/// The fields that layout 5 added.
template <class Walker>
void walk_newer(Walker& walker, Of<Walker, NodeConfig>& config) {
    walker.flag(config.verifies_registers);
    walker.number(config.ready_jitter_us);
    walker.flag(config.refuses_commands);
    walker.count(config.left_out_count, kRegistersLeftOutMax);
    for (std::size_t i = 0; i < config.left_out_count; ++i) {
        walker.number(config.left_out[i]);
    }
}

bool is_plain(const NodeConfig& config) {
    return config.verifies_registers && config.ready_jitter_us == kReadyJitterMinUs &&
           !config.refuses_commands && config.left_out_count == 0;
}

template <class T>
constexpr bool is_within(T value, T least, T most) {
    return value >= least && value <= most;
}

bool is_valid(const Roi& zone) {
    return is_within<int>(zone.width, 4, 16) && is_within<int>(zone.height, 4, 16);
}

bool is_valid_address(std::uint8_t address) {
    constexpr std::uint8_t kFactoryAddress = 0x29;
    return is_within<int>(address, 0x08, 0x77) && address != kFactoryAddress;
}

bool is_valid(const SensorConfig& sensor) {
    bool holds = sensor.bus < kNodeBusesMax && sensor.xshut_line < kNodeXshutLinesMax;
    holds &= is_valid_address(sensor.address);
    holds &= is_within(sensor.distance_mode, DistanceMode::short_range, DistanceMode::long_range);
    holds &= is_within<int>(sensor.timing_budget_ms, 15, 1000);
    holds &= is_within<int>(sensor.inter_measurement_ms, sensor.timing_budget_ms, 60'000);
    holds &= sensor.phase_us < 1000U * sensor.inter_measurement_ms;
    holds &= is_within<int>(sensor.offset_quarter_mm, -4096, 4095);
    holds &= sensor.reflex_below_mm <= kReflexLimitMaxMm;
    holds &= is_within<std::size_t>(sensor.zone_count, 1, kSensorZonesMax);
    for (std::size_t i = 0; holds && i < sensor.zone_count; ++i) {
        holds = is_valid(sensor.zones[i]);
    }
    return holds;
}

bool are_in_conflict(const SensorConfig& a, const SensorConfig& b) {
    return a.xshut_line == b.xshut_line || (a.bus == b.bus && a.address == b.address);
}

std::span<const SensorConfig> sensors_of(const NodeConfig& config) {
    return std::span(config.sensors).first(config.sensor_count);
}

bool are_sensors_valid(std::span<const SensorConfig> sensors) {
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        bool holds = is_valid(sensors[i]);
        for (std::size_t j = 0; holds && j < i; ++j) {
            holds = !are_in_conflict(sensors[i], sensors[j]);
        }
        if (!holds) {
            return false;
        }
    }
    return true;
}

bool are_left_out_valid(const NodeConfig& config) {
    if (config.left_out_count > kRegistersLeftOutMax) {
        return false;
    }
    for (std::size_t i = 0; i < config.left_out_count; ++i) {
        const bool is_ascending = i == 0 || config.left_out[i - 1] < config.left_out[i];
        if (!is_ascending || !is_verified(config.left_out[i])) {
            return false;
        }
    }
    return true;
}

bool is_jitter_valid(const NodeConfig& config) {
    const std::uint16_t most = config.holds_phases ? kReadyJitterOfPhasesMaxUs : kReadyJitterMaxUs;
    bool holds = is_within(config.ready_jitter_us, kReadyJitterMinUs, most);
    for (std::size_t i = 0; holds && i < config.sensor_count; ++i) {
        const std::uint32_t period_us = 1000U * config.sensors[i].inter_measurement_ms;
        holds = config.ready_jitter_us * kReadyJittersPerPeriodMin <= period_us ||
                config.ready_jitter_us == kReadyJitterMinUs;
    }
    return holds;
}

std::uint32_t u32_at(Bytes bytes, std::size_t at) {
    ByteReader reader(bytes.subspan(at));
    std::uint32_t value = 0;
    reader.number(value);
    return value;
}

}  // namespace

bool is_valid(const NodeConfig& config) noexcept {
    bool holds = is_within<int>(config.node_id, 1, kUnconfiguredNodeId - 1);
    holds &= is_within<std::uint32_t>(config.nominal_bitrate, 10'000, 1'000'000);
    holds &= is_within<std::uint32_t>(config.data_bitrate, config.nominal_bitrate, 8'000'000);
    holds &= is_within<std::uint32_t>(config.i2c_hz, 10'000, 400'000);
    holds &= is_within(config.stream_gate, StreamGate::off, StreamGate::advanced);
    holds &= config.data_ready_buses < 1U << kNodeBusesMax;
    holds &= config.sensor_count <= kNodeSensorsMax;
    holds = holds && is_jitter_valid(config) && are_left_out_valid(config);
    return holds && are_sensors_valid(sensors_of(config));
}

Bytes encode(const NodeConfig& config, std::span<std::uint8_t, kNodeConfigBytesMax> out) noexcept {
    ByteWriter fields(out.subspan(kHeaderBytes));
    walk(fields, config);
    if (!is_plain(config)) {
        walk_newer(fields, config);
    }
    const std::size_t covered = kHeaderBytes + fields.used();
    ByteWriter header(out.first(kHeaderBytes));
    header.number(kMagic);
    header.number(is_plain(config) ? kPlainLayout : kNodeConfigLayout);
    header.number(static_cast<std::uint16_t>(covered + kCrcBytes));
    ByteWriter end(out.subspan(covered));
    end.number(crc32(out.first(covered)));
    return out.first(covered + kCrcBytes);
}

Result<NodeConfig, NodeConfigError> decode_node_config(Bytes memory) noexcept {
    if (memory.size() < kHeaderBytes) {
        return unexpected(NodeConfigError::truncated);
    }
    if (u32_at(memory, 0) != kMagic) {
        return unexpected(NodeConfigError::wrong_magic);
    }
    const std::size_t length = u32_at(memory, 4) >> 16U;
    if (!is_within(length, kHeaderBytes + kCrcBytes, kNodeConfigBytesMax)) {
        return unexpected(NodeConfigError::wrong_length);
    }
    if (length > memory.size()) {
        return unexpected(NodeConfigError::truncated);
    }
    const std::size_t covered = length - kCrcBytes;
    if (u32_at(memory, covered) != crc32(memory.first(covered))) {
        return unexpected(NodeConfigError::wrong_crc);
    }
    const std::uint32_t layout = u32_at(memory, 4) & 0xFFFFU;
    if (layout != kPlainLayout && layout != kNodeConfigLayout) {
        return unexpected(NodeConfigError::wrong_version);
    }
    ByteReader reader(memory.subspan(kHeaderBytes, covered - kHeaderBytes));
    NodeConfig config;
    walk(reader, config);
    if (layout == kNodeConfigLayout) {
        walk_newer(reader, config);
    }
    // A block of layout 5 whose newer fields all have their defaults is not canonical: it belongs in layout
    // 4.
    const bool is_layout_needed = is_plain(config) == (layout == kPlainLayout);
    if (reader.has_failed() || !reader.is_at_end() || !is_layout_needed || !is_valid(config)) {
        return unexpected(NodeConfigError::invalid_field);
    }
    return config;
}

std::uint32_t node_hash(const NodeConfig& config) noexcept {
    std::array<std::uint8_t, kNodeConfigBytesMax> block{};
    const Bytes used = encode(config, block);
    return u32_at(used, used.size() - kCrcBytes);
}

}  // namespace octoskin
