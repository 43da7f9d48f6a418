// A map's whole state through bytes: the same bit by bit, or an error.
#include "host/io/snapshot/snapshot.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <vector>

#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/snapshot/snapshot_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/snapshot/map_states.hpp"
#include "tests/support/snapshot/mended.hpp"

namespace octoskin {
namespace {

using testing_support::MeasuredMap;
using testing_support::mended;
using testing_support::quickly_aging;
using testing_support::ScratchFolder;

constexpr std::uint32_t kMapping = 0x12345678;

SnapshotOrigin origin() {
    SnapshotOrigin origin{
        .mapping_crc32 = kMapping, .placement_crc32 = 0xBEEF, .map_crc32 = 0xCAFE, .map_time = BootTime{}};
    origin.map_time->boot.fill(7);
    origin.map_time->since_boot = Nanoseconds{123'456'789};
    return origin;
}

Result<Snapshot, Error> decode(std::string_view bytes) {
    return decode_snapshot(bytes, quickly_aging(), kMapping);
}

ErrorCode fault_of_bytes(std::string_view bytes) {
    const auto snapshot = decode(bytes);
    EXPECT_FALSE(snapshot);
    return snapshot ? ErrorCode::foreign_format : snapshot.error().code;
}

/// Of a brick: where it is, whether each voxel has a value, and the values' bits.
template <class Value>
struct KeptBrick {
    MortonCode first = 0;
    bool is_dense = false;
    std::vector<snapshot::BitsOf<Value>> bits;
    bool operator==(const KeptBrick&) const = default;
};

template <class Value>
std::vector<KeptBrick<Value>> bricks_of(const BrickTreeOf<Value>& tree) {
    std::vector<KeptBrick<Value>> bricks;
    tree.for_each([&](MortonCode first, const BrickViewOf<Value>& view) {
        KeptBrick<Value> brick{first, view.values != nullptr, {}};
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
            brick.bits.push_back(std::bit_cast<snapshot::BitsOf<Value>>(view.at(cell)));
        bricks.push_back(std::move(brick));
    });
    return bricks;
}

template <class Value>
void expect_equal(const BrickTreeOf<Value>& a, const BrickTreeOf<Value>& b) {
    EXPECT_TRUE(bricks_of(a) == bricks_of(b));
    EXPECT_EQ(a.nodes(), b.nodes());
    EXPECT_EQ(a.memory_bytes(), b.memory_bytes());
}

bool are_equal(const Beam& a, const Beam& b) {
    return a.source == b.source && a.captured == b.captured && a.p_map_sensor == b.p_map_sensor &&
           a.direction_map == b.direction_map && a.range_m == b.range_m && a.sigma_m == b.sigma_m &&
           a.clear_limit_m == b.clear_limit_m && a.optics == b.optics && a.R_map_sensor == b.R_map_sensor;
}

void expect_equal(const SensorHistories& a, const SensorHistories& b) {
    ASSERT_EQ(a.size(), b.size());
    for (const auto& [id, sensor] : a) {
        const auto& other = b.at(id);
        EXPECT_EQ(sensor.readings, other.readings);
        ASSERT_EQ(sensor.zones.size(), other.zones.size());
        for (const auto& [index, zone] : sensor.zones) {
            const auto& same = other.zones.at(index);
            ASSERT_EQ(zone.newest.size(), same.newest.size());
            for (std::size_t i = 0; i < zone.newest.size(); ++i) {
                EXPECT_TRUE(are_equal(zone.newest[i].beam, same.newest[i].beam));
                EXPECT_EQ(zone.newest[i].number, same.newest[i].number);
                EXPECT_EQ(zone.newest[i].is_confirmed, same.newest[i].is_confirmed);
            }
            ASSERT_EQ(zone.confirmed.has_value(), same.confirmed.has_value());
            EXPECT_TRUE(!zone.confirmed || are_equal(*zone.confirmed, *same.confirmed));
            ASSERT_EQ(zone.passages.size(), same.passages.size());
            for (std::size_t i = 0; i < zone.passages.size(); ++i) {
                EXPECT_TRUE(are_equal(zone.passages[i].beam, same.passages[i].beam));
                EXPECT_EQ(zone.passages[i].frees_m, same.passages[i].frees_m);
            }
        }
    }
}

void expect_equal(const MapState& a, const MapState& b) {
    const MapLayers& of_a = a.map.layers();
    const MapLayers& of_b = b.map.layers();
    expect_equal(of_a.log_odds, of_b.log_odds);
    expect_equal(of_a.counts.prior, of_b.counts.prior);
    expect_equal(of_a.counts.misses, of_b.counts.misses);
    expect_equal(of_a.counts.hits, of_b.counts.hits);
    expect_equal(of_a.ages.stamps(), of_b.ages.stamps());
    EXPECT_EQ(of_a.ages.clock(), of_b.ages.clock());
    EXPECT_EQ(of_a.known_voxels, of_b.known_voxels);
    EXPECT_EQ(a.map.has_undated(), b.map.has_undated());
    EXPECT_EQ(a.map.config(), b.map.config());
    expect_equal(a.histories, b.histories);
}

/// Few bricks, and readings of one or two zones.
std::string small_snapshot() {
    MeasuredMap small(quickly_aging());
    small.measure(3, 10, 100.0);
    return encode_snapshot(small.state(), origin());
}

TEST(Snapshot, gives_every_layer_again_bit_by_bit) {
    bool has_confirmed = false;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        MeasuredMap measured(quickly_aging());
        measured.measure(seed, 150, 100.0);
        const MapState state = measured.state();
        EXPECT_FALSE(state.map.layers().counts.empty());
        bool has_passages = false;
        for (const auto& [id, sensor] : state.histories) {
            for (const auto& [index, zone] : sensor.zones) {
                has_confirmed = has_confirmed || zone.confirmed;
                has_passages = has_passages || !zone.passages.empty();
            }
        }
        EXPECT_TRUE(has_passages);
        const std::string bytes = encode_snapshot(state, origin());
        const auto again = decode(bytes);
        ASSERT_TRUE(again) << again.error().message();
        EXPECT_EQ(again->origin, origin());
        expect_equal(again->state, state);
        EXPECT_EQ(encode_snapshot(again->state, again->origin), bytes);
    }
    EXPECT_TRUE(has_confirmed);
}

TEST(Snapshot, is_all_that_later_maps_follow_from) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        MeasuredMap live(quickly_aging());
        live.measure(seed, 90, 100.0);
        auto snapshot = decode(encode_snapshot(live.state(), origin()));
        ASSERT_TRUE(snapshot);
        MeasuredMap resumed(quickly_aging(), std::move(snapshot->state));
        for (int part = 0; part < 10; ++part) {
            for (MeasuredMap* map : {&live, &resumed})
                map->measure(100 * seed + static_cast<unsigned>(part), 40, 104.5 + 2.0 * part);
            expect_equal(resumed.state(), live.state());
            EXPECT_EQ(encode_ot(resumed.map()), encode_ot(live.map()));
        }
    }
}

TEST(Snapshot, of_an_empty_map_or_one_without_a_time_is_one_too) {
    const MapState empty{FusedMap(quickly_aging().map), {}};
    auto again = decode(encode_snapshot(empty, {.mapping_crc32 = kMapping}));
    ASSERT_TRUE(again) << again.error().message();
    expect_equal(again->state, empty);
    EXPECT_FALSE(again->origin.map_crc32 || again->origin.map_time);
    MapState timeless{FusedMap(quickly_aging().map), {}};
    ASSERT_TRUE(timeless.map.set_cube({.lowest = {32, 64, 96}, .height = 5}, 1.5F));
    ASSERT_TRUE(timeless.map.set_cube({.lowest = {8192, 0, 65534}, .height = 1}, -0.0F));
    again = decode(encode_snapshot(timeless, origin()));
    ASSERT_TRUE(again) << again.error().message();
    expect_equal(again->state, timeless);
}

TEST(Snapshot, is_refused_with_any_byte_changed_and_at_any_length) {
    const std::string bytes = small_snapshot();
    ASSERT_TRUE(decode(bytes));
    EXPECT_LT(bytes.size(), 40'000U);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::string changed = bytes;
        for (const unsigned bit : {1U, 0x10U, 0x80U, 0xFFU}) {
            changed[at] = static_cast<char>(static_cast<std::uint8_t>(bytes[at]) ^ bit);
            ASSERT_FALSE(decode(changed)) << at;
        }
    }
    for (std::size_t size = 0; size < bytes.size(); ++size)
        ASSERT_FALSE(decode(std::string_view(bytes).substr(0, size))) << size;
    EXPECT_EQ(fault_of_bytes(bytes + '\0'), ErrorCode::damaged);
    EXPECT_EQ(fault_of_bytes(bytes + bytes), ErrorCode::damaged);
}

/// A change of the format takes another version.
TEST(Snapshot, is_what_it_was_byte_for_byte) {
    const std::filesystem::path corpus =
        std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/fuzz/corpus/snapshot";
    for (const std::string name : {"small", "camera", "two-cameras"}) {
        const std::string kept = ScratchFolder::read(corpus / name);
        const auto snapshot = decode(kept);
        ASSERT_TRUE(snapshot) << snapshot.error().message();
        EXPECT_EQ(snapshot->state.cameras.size(), name == "two-cameras" ? 2U : name == "camera" ? 1U : 0U);
        EXPECT_TRUE(encode_snapshot(snapshot->state, snapshot->origin) == kept);
    }
}

/// Behind the checksums: what is accepted is the state of a map, which can be written and gone on with.
TEST(Snapshot, with_bytes_changed_and_right_checksums_is_a_possible_state_or_refused) {
    const std::string bytes = small_snapshot();
    ASSERT_EQ(mended(bytes), bytes);
    int accepted = 0;
    std::mt19937 random(5);
    for (std::size_t at = snapshot::kMagic.size(); at < bytes.size(); at += 1 + random() % 7) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(random());
        auto snapshot = decode(mended(changed));
        if (!snapshot) continue;
        ++accepted;
        const std::string written = encode_snapshot(snapshot->state, snapshot->origin);
        const auto again = decode(written);
        ASSERT_TRUE(again) << at << ": " << again.error().message();
        ASSERT_EQ(encode_snapshot(again->state, again->origin), written) << at;
        if (accepted % 20 != 0) continue;
        MeasuredMap resumed(quickly_aging(), std::move(snapshot->state));
        resumed.measure(7, 40, 100.0);
        ASSERT_TRUE(decode(encode_snapshot(resumed.state(), origin()))) << at;
    }
    EXPECT_GT(accepted, 100);
}

TEST(Snapshot, with_a_reading_that_no_sensor_has_is_refused) {
    const auto fault_with = [](const auto& change) -> std::optional<ErrorCode> {
        MeasuredMap small(quickly_aging());
        small.measure(3, 10, 100.0);
        auto state = small.state();
        change(state.histories.begin()->second.zones.begin()->second.newest.front().beam);
        const auto read = decode(encode_snapshot(state, origin()));
        return read ? std::nullopt : std::optional(read.error().code);
    };
    EXPECT_FALSE(fault_with([](Beam&) {}));
    EXPECT_EQ(fault_with([](Beam& beam) { beam.sigma_m = 1e6; }), ErrorCode::damaged);
    EXPECT_EQ(fault_with([](Beam& beam) { beam.range_m = 600.0; }), ErrorCode::damaged);
    EXPECT_EQ(fault_with([](Beam& beam) { beam.clear_limit_m = 101.0; }), ErrorCode::damaged);
    EXPECT_EQ(fault_with([](Beam& beam) { beam.optics.half_angle_rad = 0.0; }), ErrorCode::damaged);
    EXPECT_EQ(fault_with([](Beam& beam) { beam.optics.half_angle_rad = 1.0; }), ErrorCode::damaged);
    EXPECT_EQ(fault_with([](Beam& beam) { beam.optics.sigma_rad = 0.0; }), ErrorCode::damaged);
    EXPECT_EQ(fault_with([](Beam& beam) { beam.R_map_sensor *= 2.0; }), ErrorCode::damaged);
}

TEST(Snapshot, of_something_else_is_refused_by_what_it_is) {
    const std::string bytes = small_snapshot();
    EXPECT_EQ(fault_of_bytes(""), ErrorCode::foreign_format);
    EXPECT_EQ(fault_of_bytes("# Octomap OcTree file\n"), ErrorCode::foreign_format);
    std::string later = bytes;
    later[snapshot::kMagic.size() - 1] = '9';
    EXPECT_EQ(fault_of_bytes(later), ErrorCode::unsupported);
    const auto of_other = decode_snapshot(bytes, quickly_aging(), kMapping + 1);
    ASSERT_FALSE(of_other);
    EXPECT_EQ(of_other.error().code, ErrorCode::mismatch);
    MappingConfig coarse = quickly_aging();
    coarse.map.resolution_m = 0.05;
    const auto of_coarse = decode_snapshot(bytes, coarse, kMapping);
    ASSERT_FALSE(of_coarse);
    EXPECT_EQ(of_coarse.error().code, ErrorCode::mismatch);
    const MapState large{
        [] {
            FusedMap map(quickly_aging().map);
            for (std::uint16_t x = 0; x < 9; ++x)
                EXPECT_TRUE(
                    map.set_cube({.lowest = {static_cast<std::uint16_t>(64 * x), 0, 0}, .height = 5}, 1.0F));
            return map;
        }(),
        {}};
    MappingConfig small = quickly_aging();
    small.map.memory_max_mib = 1;
    const auto of_large = decode_snapshot(encode_snapshot(large, origin()), small, kMapping);
    ASSERT_FALSE(of_large);
    EXPECT_EQ(of_large.error().code, ErrorCode::too_large);
}

TEST(Snapshot, is_a_file_like_any_other) {
    const ScratchFolder folder;
    const auto file = folder / "fused.snapshot";
    EXPECT_EQ(load_snapshot(file, quickly_aging(), kMapping).error().code, ErrorCode::not_found);
    MeasuredMap measured(quickly_aging());
    measured.measure(2, 60, 100.0);
    ASSERT_TRUE(save_snapshot(measured.state(), origin(), file));
    const auto again = load_snapshot(file, quickly_aging(), kMapping);
    ASSERT_TRUE(again) << again.error().message();
    expect_equal(again->state, measured.state());
    std::filesystem::resize_file(file, std::uintmax_t{409} << 20U);
    EXPECT_EQ(load_snapshot(file, quickly_aging(), kMapping).error().code, ErrorCode::too_large);
}

}  // namespace
}  // namespace octoskin
