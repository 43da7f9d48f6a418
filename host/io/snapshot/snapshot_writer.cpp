#include "host/io/snapshot/blocks.hpp"
#include "host/io/snapshot/brick_records.hpp"
#include "host/io/snapshot/camera_records.hpp"
#include "host/io/snapshot/reading_records.hpp"
#include "host/io/snapshot/snapshot.hpp"

namespace octoskin {
namespace {

using namespace snapshot;

void put_head(ByteWriter& writer, const FusedMap& map, const SnapshotOrigin& origin) {
    writer.put(origin.mapping_crc32);
    writer.put(origin.placement_crc32);
    writer.put(map.resolution_m());
    writer.put_flag(origin.map_crc32.has_value());
    writer.put(origin.map_crc32.value_or(0));
    writer.put_flag(origin.map_time.has_value());
    const BootTime time = origin.map_time.value_or(BootTime{});
    for (const std::uint8_t byte : time.boot) writer.put(byte);
    writer.put(std::int64_t{time.since_boot.count()});
    writer.put_flag(map.has_undated());
    const VoxelAges::Clock& clock = map.layers().ages.clock();
    writer.put_flag(clock.has_begun);
    writer.put_flag(clock.waits);
    writer.put(clock.runs_for_s);
    writer.put(clock.waited_s);
    writer.put(clock.zero_s);
    writer.put(clock.now);
}

void put_done(ByteWriter& writer, const MapState& state) {
    const MapLayers& layers = state.map.layers();
    for (const BrickTree* tree :
         {&layers.log_odds, &layers.counts.prior, &layers.counts.misses, &layers.counts.hits})
        writer.put(std::uint64_t{tree->bricks()});
    writer.put(std::uint64_t{layers.ages.stamps().bricks()});
    const ZoneCounts zones = count_zones(state.histories);
    writer.put(zones.confirmed);
    writer.put(zones.seen);
}

}  // namespace

void write_snapshot(const MapState& state, const SnapshotOrigin& origin, const ByteSink& sink) {
    const MapLayers& layers = state.map.layers();
    BlockWriter blocks(sink);
    blocks.add(BlockKind::head, [&](ByteWriter& writer, bool) { put_head(writer, state.map, origin); });
    put_bricks(blocks, BlockKind::log_odds, layers.log_odds);
    put_bricks(blocks, BlockKind::prior, layers.counts.prior);
    put_bricks(blocks, BlockKind::misses, layers.counts.misses);
    put_bricks(blocks, BlockKind::hits, layers.counts.hits);
    put_bricks(blocks, BlockKind::ages, layers.ages.stamps());
    put_readings(blocks, state.histories);
    for (const CameraMemory& camera : state.cameras) put_camera(blocks, camera);
    blocks.add(BlockKind::done, [&](ByteWriter& writer, bool) { put_done(writer, state); });
    blocks.finish();
}

std::string encode_snapshot(const MapState& state, const SnapshotOrigin& origin) {
    std::string bytes;
    write_snapshot(state, origin, [&bytes](std::string_view piece) {
        bytes += piece;
        return true;
    });
    return bytes;
}

}  // namespace octoskin
