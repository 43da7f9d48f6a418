#include "host/io/snapshot/reading_records.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "host/core/beams/beam_limits.hpp"
#include "host/core/mapping/beam_rejection.hpp"

namespace octoskin::snapshot {
namespace {

void put_source(ByteWriter& writer, const BeamSource& source) {
    writer.put(source.node_id);
    writer.put(source.sensor);
    writer.put(source.zone);
}

BeamSource get_source(ByteReader& reader) {
    BeamSource source;
    source.node_id = reader.get<std::uint8_t>();
    source.sensor = reader.get<std::uint8_t>();
    source.zone = reader.get<std::uint8_t>();
    return source;
}

/// Column by column.
template <class Matrix>
void put_matrix(ByteWriter& writer, const Matrix& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) writer.put(*(matrix.data() + i));
}

template <class Matrix>
void get_matrix(ByteReader& reader, Matrix& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) *(matrix.data() + i) = reader.get<double>();
}

/// But for its source, which the record has.
void put_beam(ByteWriter& writer, const Beam& beam) {
    writer.put(beam.captured.ns);
    put_matrix(writer, beam.p_map_sensor);
    put_matrix(writer, beam.direction_map);
    writer.put_flag(beam.range_m.has_value());
    writer.put(beam.range_m.value_or(0.0));
    writer.put(beam.sigma_m);
    writer.put(beam.clear_limit_m);
    writer.put(beam.optics.half_angle_rad);
    writer.put(beam.optics.sigma_rad);
    writer.put_flag(beam.optics.is_zone);
    put_matrix(writer, beam.R_map_sensor);
}

bool is_possible(const Beam& beam) {
    // So that the difference of two of them is a time, too.
    constexpr std::int64_t kTimeMax = std::int64_t{1} << 61U;
    return beam.captured.ns >= -kTimeMax && beam.captured.ns <= kTimeMax && !fault_of(beam) &&
           std::isfinite(beam.sigma_m) && beam.sigma_m >= 0.0 && is_within_limits(beam);
}

Beam get_beam(ByteReader& reader, const BeamSource& source) {
    Beam beam;
    beam.source = source;
    beam.captured.ns = reader.get<std::int64_t>();
    get_matrix(reader, beam.p_map_sensor);
    get_matrix(reader, beam.direction_map);
    const bool has_range = reader.get_flag();
    const auto range_m = reader.get<double>();
    if (has_range) beam.range_m = range_m;
    beam.sigma_m = reader.get<double>();
    beam.clear_limit_m = reader.get<double>();
    beam.optics.half_angle_rad = reader.get<double>();
    beam.optics.sigma_rad = reader.get<double>();
    beam.optics.is_zone = reader.get_flag();
    get_matrix(reader, beam.R_map_sensor);
    if (!is_possible(beam) || (!has_range && range_m != 0.0)) reader.fail();
    return beam;
}

void put_zone(ByteWriter& writer, const ConfirmedRanges::Zone& zone) {
    writer.put(static_cast<std::uint16_t>(zone.newest.size()));
    for (const auto& reading : zone.newest) {
        put_beam(writer, reading.beam);
        writer.put(reading.number);
        writer.put_flag(reading.is_confirmed);
    }
    writer.put_flag(zone.confirmed.has_value());
    if (zone.confirmed) put_beam(writer, *zone.confirmed);
}

ConfirmedRanges::Zone get_zone(ByteReader& reader, const BeamSource& source, std::size_t readings_max,
                               std::uint64_t sensors_readings) {
    ConfirmedRanges::Zone zone;
    const auto count = reader.get<std::uint16_t>();
    if (count > readings_max) reader.fail();
    std::uint64_t before = 0;
    for (std::size_t i = 0; i < count && reader.is_sound(); ++i) {
        ConfirmedRanges::Reading reading;
        reading.beam = get_beam(reader, source);
        reading.number = reader.get<std::uint64_t>();
        reading.is_confirmed = reader.get_flag();
        if (reading.number <= before || reading.number > sensors_readings) reader.fail();
        if (!reading.beam.optics.is_cone()) reader.fail();
        before = reading.number;
        zone.newest.push_back(std::move(reading));
    }
    if (reader.get_flag()) {
        zone.confirmed = get_beam(reader, source);
        if (!zone.confirmed->range_m || !zone.confirmed->optics.is_cone() || zone.newest.empty())
            reader.fail();
    }
    return zone;
}

}  // namespace

void put_readings(BlockWriter& blocks, const StationaryReadings& readings) {
    for (const auto& sensor : readings.confirmed) {
        for (const auto& zone : sensor.second.zones) {
            blocks.add(BlockKind::confirmed, [&](ByteWriter& writer, bool) {
                put_source(writer, {sensor.first.first, sensor.first.second, zone.first});
                writer.put(sensor.second.readings);
                put_zone(writer, zone.second);
            });
        }
    }
    for (const auto& zone : readings.seen) {
        blocks.add(BlockKind::seen, [&](ByteWriter& writer, bool) {
            put_source(writer, zone.first);
            writer.put(static_cast<std::uint32_t>(zone.second.size()));
            for (const auto& reading : zone.second) {
                put_beam(writer, reading.beam);
                writer.put(reading.frees_m);
            }
        });
    }
}

bool take_confirmed(std::string_view payload, const StationaryModel& model,
                    ConfirmedRanges::Sensors& sensors) {
    // A sensor's number comes with each of its zones; as large as none can count to is none.
    constexpr std::uint64_t kReadingsMax = std::uint64_t{1} << 62U;
    ByteReader reader(payload);
    while (!reader.is_over()) {
        const BeamSource source = get_source(reader);
        const std::pair place{source.node_id, source.sensor};
        const bool is_further = sensors.empty() || place > sensors.rbegin()->first ||
                                (place == sensors.rbegin()->first &&
                                 source.zone > sensors.rbegin()->second.zones.rbegin()->first);
        if (!is_further) return false;
        const bool is_new = !sensors.contains(place);
        ConfirmedRanges::Sensor& sensor = sensors[place];
        const auto readings = reader.get<std::uint64_t>();
        if (readings > kReadingsMax || (!is_new && readings != sensor.readings)) return false;
        sensor.readings = readings;
        sensor.zones[source.zone] = get_zone(reader, source, ConfirmedRanges::readings_max(model), readings);
        if (!reader.is_sound()) return false;
    }
    return reader.is_sound();
}

bool take_seen(std::string_view payload, SeenThrough::Zones& zones) {
    ByteReader reader(payload);
    while (!reader.is_over()) {
        const BeamSource source = get_source(reader);
        if (!zones.empty() && source <= zones.rbegin()->first) return false;
        SeenThrough::Readings& newest = zones[source];
        const auto count = reader.get<std::uint32_t>();
        for (std::uint32_t i = 0; i < count && reader.is_sound(); ++i) {
            const Beam beam = get_beam(reader, source);
            const auto frees_m = reader.get<double>();
            if (!std::isfinite(frees_m) || !(frees_m > 0.0)) return false;
            newest.push_back({beam, frees_m});
        }
        if (!reader.is_sound()) return false;
    }
    return reader.is_sound();
}

std::uint64_t zones_of(const ConfirmedRanges::Sensors& sensors) noexcept {
    std::uint64_t zones = 0;
    for (const auto& entry : sensors) zones += entry.second.zones.size();
    return zones;
}

}  // namespace octoskin::snapshot
