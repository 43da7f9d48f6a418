#include "host/io/mapfile/ply_writer.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

namespace octoskin {
namespace {

/// One of a cube's six sides. Neighbouring faces along `run` are merged into one: rows are horizontal, so
/// that each has one height and one colour.
struct Side {
    int normal;  ///< axis
    int sign;
    int run;     ///< axis
    int across;  ///< axis
    double shade;
};
constexpr std::array<Side, 6> kSides = {{{0, -1, 1, 2, 0.80},
                                         {0, 1, 1, 2, 0.80},
                                         {1, -1, 0, 2, 0.65},
                                         {1, 1, 0, 2, 0.65},
                                         {2, -1, 0, 1, 0.50},
                                         {2, 1, 0, 1, 1.00}}};

using Cell = std::array<int, 3>;  // key along x, y, z
using Colour = std::array<std::uint8_t, 3>;

struct Quad {
    std::array<Eigen::Vector3f, 4> corners;
    Colour colour;
};

/// Five points of the colour map "viridis" (matplotlib), from low to high.
constexpr std::array<std::array<double, 3>, 5> kViridis = {
    {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};

/// `height` in 0..1.
Colour colour_of(double height, double shade) {
    const double position = height * (kViridis.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(position), kViridis.size() - 2);
    const double fraction = position - static_cast<double>(below);
    Colour colour{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double value = kViridis[below][i] * (1.0 - fraction) + kViridis[below + 1][i] * fraction;
        colour[i] = static_cast<std::uint8_t>(std::lround(shade * value));
    }
    return colour;
}

std::vector<Cell> occupied_cells(const FusedMap& map) {
    std::vector<Cell> cells;
    map.for_each_known([&](VoxelKey key, float log_odds) {
        if (map.occupancy_of(log_odds) == Occupancy::occupied) cells.push_back({key.x, key.y, key.z});
    });
    return cells;
}

bool is_occupied(const FusedMap& map, const Cell& cell) {
    const auto is_key = [](int value) { return value >= 0 && value < kVoxelsPerAxis; };
    if (!std::all_of(cell.begin(), cell.end(), is_key)) return false;
    return map.occupancy({static_cast<std::uint16_t>(cell[0]), static_cast<std::uint16_t>(cell[1]),
                          static_cast<std::uint16_t>(cell[2])}) == Occupancy::occupied;
}

/// The cells whose side is not covered by a neighbour, row by row, ordered within each row.
std::vector<Cell> exposed_cells(const FusedMap& map, const std::vector<Cell>& cells, const Side& side) {
    const auto axis = [](int index) { return static_cast<std::size_t>(index); };
    std::vector<Cell> exposed;
    for (const Cell& cell : cells) {
        Cell neighbour = cell;
        neighbour[axis(side.normal)] += side.sign;
        if (!is_occupied(map, neighbour)) exposed.push_back(cell);
    }
    const auto place = [&](const Cell& cell) {
        return std::tuple(cell[axis(side.normal)], cell[axis(side.across)], cell[axis(side.run)]);
    };
    std::sort(exposed.begin(), exposed.end(),
              [&](const Cell& left, const Cell& right) { return place(left) < place(right); });
    return exposed;
}

/// The rectangle over `count` cells from `first`, counter-clockwise as seen from outside.
std::array<Eigen::Vector3f, 4> corners_of(const FusedMap& map, const Cell& first, int count,
                                          const Side& side) {
    Eigen::Vector3d low(first[0], first[1], first[2]);
    if (side.sign > 0) low[side.normal] += 1.0;
    const Eigen::Vector3d along = count * Eigen::Vector3d::Unit(side.run);
    const Eigen::Vector3d across = Eigen::Vector3d::Unit(side.across);
    std::array<Eigen::Vector3d, 4> corners = {low, low + along, low + along + across, low + across};
    const bool is_outward = along.cross(across)[side.normal] * side.sign > 0.0;
    if (!is_outward) std::swap(corners[1], corners[3]);
    std::array<Eigen::Vector3f, 4> placed;
    for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector3d steps = corners[i].array() - kOriginKey;
        placed[i] = (steps * map.resolution_m()).cast<float>();
    }
    return placed;
}

std::vector<Quad> merged_faces(const FusedMap& map) {
    const std::vector<Cell> cells = occupied_cells(map);
    std::vector<Quad> quads;
    if (cells.empty()) return quads;
    const auto by_height = [](const Cell& left, const Cell& right) { return left[2] < right[2]; };
    const auto [lowest, highest] = std::minmax_element(cells.begin(), cells.end(), by_height);
    const double span = std::max(1, (*highest)[2] - (*lowest)[2]);
    for (const Side& side : kSides) {
        const std::vector<Cell> exposed = exposed_cells(map, cells, side);
        for (std::size_t begin = 0; begin < exposed.size();) {
            std::size_t end = begin + 1;
            Cell next = exposed[begin];
            ++next[static_cast<std::size_t>(side.run)];
            for (; end < exposed.size() && exposed[end] == next; ++end)
                ++next[static_cast<std::size_t>(side.run)];
            const double height = (exposed[begin][2] - (*lowest)[2]) / span;
            quads.push_back({corners_of(map, exposed[begin], static_cast<int>(end - begin), side),
                             colour_of(height, side.shade)});
            begin = end;
        }
    }
    return quads;
}

void append(std::string& bytes, std::uint32_t value) {
    for (unsigned i = 0; i < 4; ++i) bytes.push_back(static_cast<char>((value >> (8 * i)) & 0xFFU));
}

}  // namespace

std::string encode_ply(const FusedMap& map) {
    const std::vector<Quad> quads = merged_faces(map);
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment occupied voxels of {} m, map frame, metres\n"
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        map.resolution_m(), 4 * quads.size(), quads.size());
    for (const Quad& quad : quads) {
        for (const Eigen::Vector3f& corner : quad.corners) {
            for (int axis = 0; axis < 3; ++axis) append(bytes, std::bit_cast<std::uint32_t>(corner[axis]));
            for (const std::uint8_t channel : quad.colour) bytes.push_back(static_cast<char>(channel));
        }
    }
    for (std::uint32_t face = 0; face < quads.size(); ++face) {
        bytes.push_back(4);
        for (std::uint32_t corner = 0; corner < 4; ++corner) append(bytes, 4 * face + corner);
    }
    return bytes;
}

}  // namespace octoskin
