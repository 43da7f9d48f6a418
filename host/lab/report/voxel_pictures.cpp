#include <array>
#include <cassert>
#include <set>
#include <tuple>

#include "host/core/voxels/voxel_lattice.hpp"
#include "host/lab/report/pictures.hpp"
#include "host/lab/report/tracer.hpp"

namespace octoskin::report {
namespace {

Colour colour_of_kind(VoxelKind kind) {
    switch (kind) {
        case VoxelKind::right:
            return colour_of(palette::kRight);
        case VoxelKind::hidden_object:
            return colour_of(palette::kHiddenObject);
        case VoxelKind::wrong:
            return colour_of(palette::kWrong);
        case VoxelKind::lost:
            return colour_of(palette::kLost);
        case VoxelKind::floor:
            break;
    }
    return colour_of(palette::kFloor);
}

VoxelKind kind_of(const evaluation::SurfaceVoxel& truth) {
    if (truth.is_hidden_object) {
        return VoxelKind::hidden_object;
    }
    return truth.is_surface || truth.is_interior ? VoxelKind::right : VoxelKind::wrong;
}

using KeySet = std::set<VoxelKey>;

VoxelKey neighbour(VoxelKey key, int axis, int side) {
    std::array<std::uint16_t, 3> xyz = {key.x, key.y, key.z};
    auto& moved = xyz[static_cast<std::size_t>(axis)];
    moved = static_cast<std::uint16_t>(moved + side);
    return {xyz[0], xyz[1], xyz[2]};
}

/// The face of a voxel towards `side` (-1 or 1) of an axis; corners anticlockwise from outside.
Face face_of(const Eigen::Vector3f& centre, float edge_m, int axis, int side, Colour colour) {
    const Eigen::Vector3f out = static_cast<float>(side) * Eigen::Vector3f::Unit(axis);
    const Eigen::Vector3f across = Eigen::Vector3f::Unit((axis + 1) % 3);
    const Eigen::Vector3f along = out.cross(across);
    const float half = edge_m / 2.0F;
    return {{centre + half * (out - across - along), centre + half * (out + across - along),
             centre + half * (out + across + along), centre + half * (out - across + along)},
            colour};
}

/// Adds outer faces only: a face between two drawn voxels is not visible.
void add_cube(Geometry& geometry, const PaintedVoxel& voxel, const KeySet& drawn,
              const VoxelLattice& lattice) {
    const Eigen::Vector3f centre = lattice.centre_of(voxel.key).cast<float>();
    const auto edge_m = static_cast<float>(lattice.resolution_m());
    for (int axis = 0; axis < 3; ++axis) {
        for (const int side : {-1, 1}) {
            if (!drawn.contains(neighbour(voxel.key, axis, side))) {
                geometry.faces.push_back(face_of(centre, edge_m, axis, side, colour_of_kind(voxel.kind)));
            }
        }
    }
}

/// An edge of the lattice: it runs along `axis` from the low corner of a voxel.
using LatticeEdge = std::tuple<VoxelKey, int>;

void add_cube_edges(std::set<LatticeEdge>& edges, VoxelKey key) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const int u : {0, 1}) {
            for (const int v : {0, 1}) {
                const VoxelKey corner = neighbour(neighbour(key, (axis + 1) % 3, u), (axis + 2) % 3, v);
                edges.insert({corner, axis});
            }
        }
    }
}

void add_frames(Geometry& geometry, const std::set<LatticeEdge>& edges, const VoxelLattice& lattice) {
    constexpr float kShareOfEdge = 0.035F;
    const auto edge_m = static_cast<float>(lattice.resolution_m());
    for (const auto& [corner, axis] : edges) {
        const Eigen::Vector3f from =
            lattice.centre_of(corner).cast<float>() - Eigen::Vector3f::Constant(edge_m / 2.0F);
        geometry.lines.push_back({from, from + edge_m * Eigen::Vector3f::Unit(axis), kShareOfEdge * edge_m,
                                  colour_of_kind(VoxelKind::lost)});
    }
}

}  // namespace

std::vector<PaintedVoxel> paint_map(const FusedMap& map, const evaluation::Truth& truth) {
    assert(map.resolution_m() == truth.resolution_m);
    const evaluation::KeyBox& region = truth.region();
    evaluation::KeyBox drawn = region;
    drawn.min.z = static_cast<std::uint16_t>(drawn.min.z - 1);
    std::vector<PaintedVoxel> painted;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        const VoxelKey key = drawn.key_at(i);
        const Occupancy occupancy = map.occupancy(key);
        if (!region.contains(key)) {
            if (occupancy == Occupancy::occupied) {
                painted.push_back({key, VoxelKind::floor});
            }
            continue;
        }
        const auto& surface = truth.surface.at(key);
        if (occupancy == Occupancy::occupied) {
            painted.push_back({key, kind_of(surface)});
        } else if (occupancy == Occupancy::free && surface.is_surface) {
            painted.push_back({key, VoxelKind::lost});
        }
    }
    return painted;
}

std::vector<PaintedVoxel> paint_truth(const evaluation::Truth& truth) {
    std::vector<PaintedVoxel> painted;
    for (std::size_t i = 0; i < truth.surface.size(); ++i) {
        if (truth.surface[i].is_surface) {
            painted.push_back({truth.region().key_at(i), kind_of(truth.surface[i])});
        }
    }
    return painted;
}

Eigen::AlignedBox3d content_of(std::span<const std::vector<PaintedVoxel>> lists, double resolution_m) {
    const VoxelLattice lattice(resolution_m);
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(resolution_m / 2.0);
    Eigen::AlignedBox3d content;
    for (const auto& voxels : lists) {
        for (const auto& voxel : voxels) {
            if (voxel.kind != VoxelKind::floor) {
                const Eigen::Vector3d centre = lattice.centre_of(voxel.key);
                content.extend(Eigen::AlignedBox3d(centre - half, centre + half));
            }
        }
    }
    return content;
}

ImagePair render_voxels(std::span<const PaintedVoxel> voxels, double resolution_m, const ViewPair& views) {
    const VoxelLattice lattice(resolution_m);
    KeySet drawn;
    std::set<LatticeEdge> frames;
    for (const auto& voxel : voxels) {
        if (voxel.kind == VoxelKind::lost) {
            add_cube_edges(frames, voxel.key);
        } else {
            drawn.insert(voxel.key);
        }
    }
    Geometry geometry;
    for (const auto& voxel : voxels) {
        if (voxel.kind != VoxelKind::lost) {
            add_cube(geometry, voxel, drawn, lattice);
        }
    }
    add_frames(geometry, frames, lattice);
    const Tracer tracer(geometry);
    return {tracer.render(views.front), tracer.render(views.back)};
}

}  // namespace octoskin::report
