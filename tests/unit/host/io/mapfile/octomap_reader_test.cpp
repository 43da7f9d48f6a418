#include "host/io/mapfile/octomap_reader.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>
#include <string>

#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/support/octomap_oracle.hpp"
#include "tests/unit/host/io/mapfile/map_samples.hpp"

namespace octoskin {
namespace {

std::string ot_header(const std::string& lines) {
    return "# Octomap OcTree file\n" + lines + "data\n";
}
std::string bt_header(const std::string& lines) {
    return "# Octomap OcTree binary file\n" + lines + "data\n";
}
const std::string kOctoskins = "# saved by octoskin\n";

std::string fields(std::uint64_t nodes) {
    return "id OcTree\nsize " + std::to_string(nodes) + "\nres 0.04\n";
}

/// A node of a .ot.
std::string node(float log_odds, unsigned children) {
    const auto bits = std::bit_cast<std::uint32_t>(log_odds);
    std::string bytes;
    for (unsigned i = 0; i < 4; ++i) bytes.push_back(static_cast<char>((bits >> (8 * i)) & 0xFFU));
    bytes.push_back(static_cast<char>(children));
    return bytes;
}

/// A .ot whose only leaf lies `levels` below the root, always child 0.
std::string chain(unsigned levels, float leaf) {
    std::string bytes = ot_header(fields(levels + 1));
    for (unsigned i = 0; i < levels; ++i) bytes += node(leaf, 1);
    return bytes + node(leaf, 0);
}

/// Empty if the bytes were taken.
std::optional<MapFault> fault_of(const std::string& bytes, const MapReadLimits& limits = {}) {
    const auto map = decode_octomap(bytes, limits);
    if (map) return std::nullopt;
    EXPECT_FALSE(map.error().what.empty());
    return map.error().fault;
}

/// Of bytes that must be taken.
std::size_t warnings_of(const std::string& bytes) {
    const auto map = decode_octomap(bytes, {});
    EXPECT_TRUE(map.has_value()) << map.error().what;
    return map ? map->warnings.size() : 0;
}

TEST(OctomapReader, reads_what_was_written) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        const FusedMap map = samples::random_map(seed);
        const auto from_ot = decode_octomap(encode_ot(map), {});
        ASSERT_TRUE(from_ot.has_value());
        EXPECT_EQ(oracle::voxels_of(from_ot->map), oracle::voxels_of(map));
        EXPECT_EQ(from_ot->map.resolution_m(), 0.04);
        EXPECT_EQ(encode_ot(from_ot->map), encode_ot(map));
        const auto from_bt = decode_octomap(encode_bt(map), {});
        ASSERT_TRUE(from_bt.has_value());
        EXPECT_EQ(encode_bt(from_bt->map), encode_bt(map));
        EXPECT_EQ(from_bt->map.known_voxels(), map.known_voxels());
    }
}

/// As it was in the map, whatever the reader's own limits say; OctoMap reads the file as ever.
TEST(OctomapReader, takes_for_occupied_what_octoskin_saved_as_occupied) {
    for (const float from : {-1.2F, 0.0F, 0.1F}) {
        MapConfig config;
        config.log_odds_occupied = from;
        FusedMap map{config};
        ASSERT_TRUE(map.set_cube({.lowest = {32, 64, 96}, .height = 1}, -1.0F));
        ASSERT_TRUE(map.set_cube({.lowest = {64, 64, 96}, .height = 1}, 0.05F));
        const std::string bytes = encode_ot(map);
        const auto loaded = decode_octomap(bytes, {});
        ASSERT_TRUE(loaded) << loaded.error().what;
        for (const VoxelKey key : {VoxelKey{32, 64, 96}, VoxelKey{64, 64, 96}})
            EXPECT_EQ(loaded->map.occupancy(key), map.occupancy(key)) << from;
        EXPECT_EQ(encode_ot(loaded->map), bytes);
        std::istringstream text(bytes);
        const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(text));
        ASSERT_NE(read, nullptr);
        EXPECT_EQ(read->size(), dynamic_cast<octomap::OcTree&>(*read).calcNumNodes());
    }
    const std::string saved = kOctoskins + "# occupied from log-odds ";
    EXPECT_EQ(fault_of(ot_header(saved + "-1.2\n" + fields(0))), std::nullopt);
    for (const char* number : {"", "x", "nan", "1e9", "-1.2 m"})
        EXPECT_EQ(fault_of(ot_header(saved + number + "\n" + fields(0))), MapFault::header_malformed)
            << number;
}

// Oracle: OctoMap's writer, on a tree of its own with another resolution.
TEST(OctomapReader, reads_what_octomap_wrote) {
    MapConfig config;
    config.resolution_m = 0.1;
    oracle::ClampedTree tree(config);
    for (int i = 0; i < 3000; ++i) {
        tree.updateNode(
            octomap::point3d(static_cast<float>(i % 17) * 0.1F, static_cast<float>(i % 31) * -0.1F, 1.0F),
            i % 3 == 0);
    }
    std::ostringstream text;
    ASSERT_TRUE(tree.write(text));
    const auto map = decode_octomap(text.str(), {});
    ASSERT_TRUE(map.has_value());
    EXPECT_EQ(map->map.resolution_m(), 0.1);
    EXPECT_EQ(oracle::voxels_of(map->map), oracle::voxels_of(tree));
}

TEST(OctomapReader, takes_an_empty_map_and_a_resolution_of_many_digits) {
    EXPECT_EQ(fault_of(ot_header(fields(0))), std::nullopt);
    EXPECT_EQ(fault_of(bt_header(fields(0))), std::nullopt);
    const auto map =
        decode_octomap(ot_header("res 0.030000000000000002\n# a comment\nid OcTree\nsize 0\n"), {});
    ASSERT_TRUE(map.has_value());
    EXPECT_EQ(map->map.resolution_m(), 0.030000000000000002);
}

TEST(OctomapReader, refuses_every_truncation_of_both_formats) {
    for (const std::string& whole : {encode_ot(samples::small_map()), encode_bt(samples::small_map())}) {
        EXPECT_EQ(fault_of(whole), std::nullopt);
        for (std::size_t length = 0; length < whole.size(); ++length) {
            EXPECT_NE(fault_of(whole.substr(0, length)), std::nullopt)
                << length << " bytes of " << whole.size();
        }
        EXPECT_EQ(fault_of(whole + '\0'), MapFault::trailing_bytes);
    }
}

TEST(OctomapReader, takes_or_refuses_every_flipped_bit_and_what_it_takes_is_sane) {
    for (const std::string& whole : {encode_ot(samples::small_map()), encode_bt(samples::small_map())}) {
        for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
            std::string flipped = whole;
            flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
            MapReadLimits limits;
            limits.map.memory_max_mib = 4;
            const auto map = decode_octomap(flipped, limits);
            if (!map) continue;
            map->map.for_each_known([&](VoxelKey, float log_odds) {
                ASSERT_TRUE(log_odds >= -2.0F && log_odds <= 3.5F) << "bit " << bit;
            });
        }
    }
}

TEST(OctomapReader, names_what_is_wrong_with_a_header) {
    EXPECT_EQ(fault_of(""), MapFault::not_a_map);
    EXPECT_EQ(fault_of("ply\nformat binary\n"), MapFault::not_a_map);
    EXPECT_EQ(fault_of(std::string(10'000, 'x')), MapFault::not_a_map);
    EXPECT_EQ(fault_of(ot_header("id CountingOcTree\nsize 0\nres 0.04\n")), MapFault::wrong_tree_type);
    EXPECT_EQ(fault_of(ot_header("id OcTree\nsize 0\n")), MapFault::header_malformed);
    EXPECT_EQ(fault_of(ot_header("id OcTree\nres 0.04\n")), MapFault::truncated);
    EXPECT_EQ(fault_of(ot_header("size 0\nres 0.04\n")), MapFault::header_malformed);
    EXPECT_EQ(fault_of(ot_header("id OcTree\nsize x\nres 0.04\n")), MapFault::header_malformed);
    EXPECT_EQ(fault_of(ot_header("id OcTree\nsize 99999999999999999999\nres 0.04\n")),
              MapFault::header_malformed);
    EXPECT_EQ(fault_of("# Octomap OcTree file\n" + std::string(2U << 20U, '#') + "\n" + fields(0) + "data\n"),
              MapFault::header_malformed);
    for (const char* resolution : {"0", "-0.04", "nan", "inf", "1e-9", "1e9", "", "m", "0,04"}) {
        EXPECT_EQ(fault_of(ot_header("id OcTree\nsize 0\nres " + std::string(resolution) + "\n")),
                  MapFault::resolution_not_valid)
            << resolution;
    }
}

TEST(OctomapReader, refuses_more_nodes_than_its_limit_before_reading_any) {
    EXPECT_EQ(fault_of(ot_header(kOctoskins + fields(50'000'001))), MapFault::too_many_nodes);
    EXPECT_EQ(fault_of(chain(16, 1.0F), {.map = {}, .nodes_max = 16}), MapFault::too_many_nodes);
    EXPECT_EQ(fault_of(chain(16, 1.0F), {.map = {}, .nodes_max = 17}), std::nullopt);
}

TEST(OctomapReader, refuses_a_tree_deeper_than_sixteen_levels) {
    EXPECT_EQ(fault_of(chain(16, 1.0F)), std::nullopt);
    EXPECT_EQ(fault_of(chain(17, 1.0F)), MapFault::too_deep);
    EXPECT_EQ(fault_of(chain(1'000'000, 1.0F)), MapFault::too_deep);
    // .bt: inner nodes all the way down to level 16.
    std::string deep = bt_header(fields(17));
    for (int i = 0; i < 17; ++i) deep += std::string("\x03\x00", 2);
    EXPECT_EQ(fault_of(deep), MapFault::too_deep);
}

TEST(OctomapReader, refuses_a_wrong_node_count_of_a_map_that_octoskin_saved) {
    const std::string nodes = chain(16, 1.0F).substr(ot_header(fields(17)).size());
    const auto octoskins = [&](std::uint64_t said) { return ot_header(kOctoskins + fields(said)); };
    EXPECT_EQ(fault_of(octoskins(17) + nodes), std::nullopt);
    EXPECT_EQ(fault_of(octoskins(16) + nodes), MapFault::node_count_differs);
    EXPECT_EQ(fault_of(octoskins(18) + nodes), MapFault::node_count_differs);
    EXPECT_EQ(fault_of(octoskins(0) + nodes), MapFault::trailing_bytes);
    EXPECT_EQ(fault_of(octoskins(17) + nodes + "\n"), MapFault::trailing_bytes);
    // It stops there: what follows is not looked at.
    const std::string bad_third = node(1.0F, 1) + node(1.0F, 1) + node(99.0F, 0);
    EXPECT_EQ(fault_of(octoskins(1) + bad_third), MapFault::node_count_differs);
}

TEST(OctomapReader, reads_another_programs_tree_if_its_count_or_its_end_speaks_for_it) {
    const std::string nodes = chain(16, 1.0F).substr(ot_header(fields(17)).size());
    for (const std::uint64_t said : {0U, 1U, 16U, 18U, 50'000'001U})
        EXPECT_EQ(warnings_of(ot_header(fields(said)) + nodes), 1U) << said;
    EXPECT_EQ(warnings_of(ot_header("id OcTree\nres 0.04\n") + nodes), 1U);
    EXPECT_EQ(warnings_of(ot_header(fields(17)) + nodes + "\n"), 1U);
    EXPECT_EQ(warnings_of(ot_header(fields(17)) + nodes), 0U);
    EXPECT_EQ(fault_of(ot_header(fields(16)) + nodes + "\n"), MapFault::node_count_differs);
    EXPECT_EQ(fault_of(ot_header(fields(18)) + nodes + "\n"), MapFault::node_count_differs);
    for (const std::uint64_t said : {0U, 1U, 16U, 17U, 18U}) {
        EXPECT_EQ(fault_of(ot_header(fields(said)) + nodes.substr(0, nodes.size() - 1)), MapFault::truncated)
            << said;
    }
    EXPECT_EQ(fault_of(ot_header(fields(17))), MapFault::truncated);
}

TEST(OctomapReader, refuses_log_odds_that_are_no_number_or_beyond_the_clamps) {
    EXPECT_EQ(fault_of(chain(16, std::numeric_limits<float>::quiet_NaN())), MapFault::log_odds_not_finite);
    EXPECT_EQ(fault_of(chain(16, std::numeric_limits<float>::infinity())), MapFault::log_odds_not_finite);
    EXPECT_EQ(fault_of(chain(16, std::nextafter(3.5F, 9.0F))), MapFault::log_odds_outside_clamps);
    EXPECT_EQ(fault_of(chain(16, std::nextafter(-2.0F, -9.0F))), MapFault::log_odds_outside_clamps);
    EXPECT_EQ(fault_of(chain(16, 3.5F)), std::nullopt);
    MapReadLimits octomaps_defaults;
    octomaps_defaults.map.log_odds_max = 3.5111F;
    EXPECT_EQ(fault_of(chain(16, 3.5110F), octomaps_defaults), std::nullopt);
}

TEST(OctomapReader, refuses_an_inner_node_without_children) {
    EXPECT_EQ(fault_of(bt_header(fields(1)) + std::string(2, '\0')), MapFault::inner_node_empty);
    EXPECT_EQ(fault_of(bt_header(fields(2)) + std::string("\x03\x00\x00\x00", 4)),
              MapFault::inner_node_empty);
}

TEST(OctomapReader, refuses_a_map_that_does_not_fit_its_memory) {
    EXPECT_EQ(fault_of(chain(0, 1.0F)), MapFault::no_room);  // one leaf for all 2^48 voxels
    EXPECT_EQ(fault_of(chain(4, 1.0F)), MapFault::no_room);
    EXPECT_EQ(fault_of(bt_header(fields(2)) + std::string("\x02\x00", 2)), MapFault::no_room);
    EXPECT_EQ(fault_of(chain(10, 1.0F)), std::nullopt);  // a leaf of 64 voxels' edge
}

}  // namespace
}  // namespace octoskin
