#include "host/io/mapfile/ply_writer.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "tests/unit/host/io/mapfile/map_samples.hpp"

namespace octoskin {
namespace {

using samples::key;

struct Mesh {
    std::vector<Eigen::Vector3f> vertices;
    std::vector<std::array<std::uint8_t, 3>> colours;
    std::vector<std::array<std::int32_t, 4>> faces;
};

/// Reads the file back by the PLY rules, independently of the writer's types.
Mesh parse(const std::string& bytes) {
    Mesh mesh;
    const auto number_after = [&](const std::string& text) {
        return std::stoul(bytes.substr(bytes.find(text) + text.size()));
    };
    EXPECT_EQ(bytes.substr(0, 36), "ply\nformat binary_little_endian 1.0\n");
    const std::size_t vertices = number_after("element vertex ");
    const std::size_t faces = number_after("element face ");
    const char* data = bytes.data() + bytes.find("end_header\n") + 11;
    for (std::size_t i = 0; i < vertices; ++i, data += 15) {
        float position[3];
        std::memcpy(position, data, 12);
        mesh.vertices.emplace_back(position[0], position[1], position[2]);
        std::array<std::uint8_t, 3> colour{};
        std::memcpy(colour.data(), data + 12, 3);
        mesh.colours.push_back(colour);
    }
    for (std::size_t i = 0; i < faces; ++i, data += 17) {
        EXPECT_EQ(*data, 4);
        std::array<std::int32_t, 4> corners{};
        std::memcpy(corners.data(), data + 1, 16);
        mesh.faces.push_back(corners);
    }
    EXPECT_EQ(data, bytes.data() + bytes.size());
    return mesh;
}

/// By the divergence theorem; positive only if the faces look outwards.
double volume_of(const Mesh& mesh) {
    double volume = 0.0;
    for (const auto& face : mesh.faces) {
        const auto corner = [&](std::size_t i) -> Eigen::Vector3d {
            return mesh.vertices.at(static_cast<std::size_t>(face[i])).cast<double>();
        };
        for (const std::size_t i : {1U, 2U}) volume += corner(0).dot(corner(i).cross(corner(i + 1))) / 6.0;
    }
    return volume;
}

FusedMap occupied(const std::vector<VoxelKey>& keys) {
    FusedMap map(MapConfig{});
    for (const VoxelKey voxel : keys) feed(map, std::vector<VoxelUpdate>{{voxel, 1.0F}});
    return map;
}

TEST(PlyWriter, shows_one_voxel_as_a_closed_cube_in_its_place) {
    const Mesh mesh = parse(encode_ply(occupied({key(10, -5, 2)})));
    EXPECT_EQ(mesh.faces.size(), 6U);
    EXPECT_EQ(mesh.vertices.size(), 24U);
    EXPECT_NEAR(volume_of(mesh), 0.04 * 0.04 * 0.04, 1e-9);
    for (const auto& vertex : mesh.vertices) {
        EXPECT_TRUE(vertex.x() >= 0.3999F && vertex.x() <= 0.4401F) << vertex.transpose();
        EXPECT_TRUE(vertex.y() >= -0.2001F && vertex.y() <= -0.1599F) << vertex.transpose();
        EXPECT_TRUE(vertex.z() >= 0.0799F && vertex.z() <= 0.1201F) << vertex.transpose();
    }
}

TEST(PlyWriter, merges_a_row_and_leaves_out_faces_between_neighbours) {
    std::vector<VoxelKey> row;
    for (int x = 0; x < 10; ++x) row.push_back(key(x, 0, 0));
    const Mesh mesh = parse(encode_ply(occupied(row)));
    EXPECT_EQ(mesh.faces.size(), 6U);
    EXPECT_NEAR(volume_of(mesh), 10 * 6.4e-5, 1e-9);
}

TEST(PlyWriter, encloses_the_volume_of_any_shape) {
    const FusedMap map = samples::random_map(9);
    std::size_t voxels = 0;
    map.for_each_known([&](VoxelKey, float log_odds) { voxels += log_odds >= 0.0F ? 1U : 0U; });
    ASSERT_GT(voxels, 100U);
    EXPECT_NEAR(volume_of(parse(encode_ply(map))), static_cast<double>(voxels) * 6.4e-5, 1e-6);
}

TEST(PlyWriter, colours_by_height_and_shows_occupied_voxels_only) {
    FusedMap map = occupied({key(0, 0, 0), key(0, 0, 10)});
    feed(map, std::vector<VoxelUpdate>{{key(0, 0, 20), -1.0F}});
    const Mesh mesh = parse(encode_ply(map));
    EXPECT_EQ(mesh.faces.size(), 12U);
    // The top faces come last, unshaded: the ends of the colour map.
    EXPECT_EQ(mesh.colours[4 * 10], (std::array<std::uint8_t, 3>{68, 1, 84}));
    EXPECT_EQ(mesh.colours[4 * 11], (std::array<std::uint8_t, 3>{253, 231, 37}));
}

TEST(PlyWriter, writes_a_valid_file_for_an_empty_map) {
    EXPECT_TRUE(parse(encode_ply(FusedMap(MapConfig{}))).faces.empty());
}

}  // namespace
}  // namespace octoskin
