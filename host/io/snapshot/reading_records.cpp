#include "host/io/snapshot/reading_records.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "host/core/beams/beam_limits.hpp"
#include "host/core/mapping/beam_rejection.hpp"
#include "host/core/mapping/confirmed_ranges.hpp"
#include "host/io/snapshot/matrices.hpp"

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

/// Without its source, which the record contains.
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
    // The difference of two times must also be a valid time.
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

void put_zone(ByteWriter& writer, const ZoneHistory& zone) {
    writer.put(static_cast<std::uint16_t>(zone.newest.size()));
    for (const auto& reading : zone.newest) {
        put_beam(writer, reading.beam);
        writer.put(reading.number);
        writer.put_flag(reading.is_confirmed);
    }
    writer.put_flag(zone.confirmed.has_value());
    if (zone.confirmed) put_beam(writer, *zone.confirmed);
}

void get_zone(ByteReader& reader, const BeamSource& source, std::size_t readings_max,
              std::uint64_t sensors_readings, ZoneHistory& zone) {
    const auto count = reader.get<std::uint16_t>();
    if (count > readings_max) reader.fail();
    std::uint64_t before = 0;
    for (std::size_t i = 0; i < count && reader.is_sound(); ++i) {
        ZoneHistory::Reading reading;
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
}

/// Zones with a state in ConfirmedRanges: all of a sensor with at least one reading.
bool has_confirming(const SensorHistory& sensor) {
    return sensor.readings > 0;
}

/// Whether `source` comes after all previous ones; if so, it becomes the newest.
bool is_further(std::optional<BeamSource>& newest, const BeamSource& source) {
    const bool is = !newest || *newest < source;
    newest = source;
    return is;
}

}  // namespace

void put_readings(BlockWriter& blocks, const SensorHistories& histories) {
    const auto for_each_zone = [&](const auto& put) {
        for (const auto& [id, sensor] : histories)
            for (const auto& [index, zone] : sensor.zones)
                put(BeamSource{id.node_id, id.sensor, index}, sensor, zone);
    };
    for_each_zone([&](const BeamSource& source, const SensorHistory& sensor, const ZoneHistory& zone) {
        if (!has_confirming(sensor)) return;
        blocks.add(BlockKind::confirmed, [&](ByteWriter& writer, bool) {
            put_source(writer, source);
            writer.put(sensor.readings);
            put_zone(writer, zone);
        });
    });
    for_each_zone([&](const BeamSource& source, const SensorHistory&, const ZoneHistory& zone) {
        if (zone.passages.empty()) return;
        blocks.add(BlockKind::seen, [&](ByteWriter& writer, bool) {
            put_source(writer, source);
            writer.put(static_cast<std::uint32_t>(zone.passages.size()));
            for (const auto& passage : zone.passages) {
                put_beam(writer, passage.beam);
                writer.put(passage.frees_m);
            }
        });
    });
}

bool ReadingsTaker::take_confirmed(std::string_view payload, const StationaryModel& model) {
    // A sensor's number of readings is stored with each of its zones; a count so large that it cannot occur
    // is invalid.
    constexpr std::uint64_t kReadingsMax = std::uint64_t{1} << 62U;
    ByteReader reader(payload);
    while (!reader.is_over()) {
        const BeamSource source = get_source(reader);
        if (!is_further(newest_confirmed_, source)) return false;
        SensorHistory& sensor = histories_[source.sensor_id()];
        const auto readings = reader.get<std::uint64_t>();
        const bool is_first = !has_confirming(sensor);
        if (readings == 0 || readings > kReadingsMax || (!is_first && readings != sensor.readings))
            return false;
        sensor.readings = readings;
        get_zone(reader, source, ConfirmedRanges::readings_max(model), readings, sensor.zones[source.zone]);
        if (!reader.is_sound()) return false;
    }
    return reader.is_sound();
}

bool ReadingsTaker::take_seen(std::string_view payload) {
    ByteReader reader(payload);
    while (!reader.is_over()) {
        const BeamSource source = get_source(reader);
        if (!is_further(newest_seen_, source)) return false;
        auto& passages = histories_[source.sensor_id()].zones[source.zone].passages;
        const auto count = reader.get<std::uint32_t>();
        for (std::uint32_t i = 0; i < count && reader.is_sound(); ++i) {
            const Beam beam = get_beam(reader, source);
            const auto frees_m = reader.get<double>();
            if (!std::isfinite(frees_m) || !(frees_m > 0.0)) return false;
            passages.push_back({beam, frees_m});
        }
        if (count == 0 || !reader.is_sound()) return false;
    }
    return reader.is_sound();
}

ZoneCounts count_zones(const SensorHistories& histories) noexcept {
    ZoneCounts counts;
    for (const auto& entry : histories) {
        const SensorHistory& sensor = entry.second;
        if (has_confirming(sensor)) counts.confirmed += sensor.zones.size();
        for (const auto& zone : sensor.zones) counts.seen += zone.second.passages.empty() ? 0U : 1U;
    }
    return counts;
}

}  // namespace octoskin::snapshot
