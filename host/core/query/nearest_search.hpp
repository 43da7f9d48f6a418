// The search behind the queries of capsule_query.hpp: the occupied and the unknown voxel of a map nearest to
// a segment.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "host/core/bricks/brick.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/query/cube_geometry.hpp"
#include "host/core/query/segment_cube.hpp"

namespace octoskin {

/// Resolution of distances. Rounding is well below it for all points within 1000 km.
inline constexpr double kDistanceStep_m = 1e-9;

/// Occupied and unknown voxels of a map's brick, computed in advance.
struct BrickSites {
    BrickMask occupied{};
    BrickMask unknown{};
};

enum class SearchFor : std::uint8_t {
    worst,  ///< the nearest occupied voxel or, if there is none, the nearest unknown one
    any,    ///< ends with the first voxel that is not free
    both,   ///< the nearest occupied one, and the nearest unknown one unless it is further away
};

struct SearchRequest {
    Eigen::Vector3d p_a = Eigen::Vector3d::Zero();  ///< the segment's ends in the map frame, finite
    Eigen::Vector3d p_b = Eigen::Vector3d::Zero();
    /// From the segment to a voxel's closed cube; voxels beyond are not found.
    double occupied_reach_m = 0.0;
    double unknown_reach_m = 0.0;  ///< at most occupied_reach_m, except for `both`
    SearchFor wanted = SearchFor::worst;
};

/// Searches the space within reach in Morton order: of two equally near voxels the first is taken without a
/// comparison. Used for one `run`, or with `look_at` for each candidate, in any order, by callers that know
/// the candidates.
class NearestSearch {
  public:
    struct Found {
        std::optional<VoxelKey> voxel;
        double distance_m = 0.0;  ///< to its closed cube, in whole steps
    };

    NearestSearch(const FusedMap& map, const SearchRequest& request) noexcept;

    void run() noexcept;
    /// Tests a brick of the map with occupied or unknown voxels.
    void look_at(const VoxelCube& brick, const BrickSites& sites) noexcept;
    /// Test cubes whose voxels are all occupied, or all unknown.
    void look_at_occupied(const VoxelCube& cube) noexcept { take(occupied_, cube); }
    void look_at_unknown(const VoxelCube& cube) noexcept { take(unknown_, cube); }
    /// Voxels further away cannot change either result. Never more than the request's reach.
    [[nodiscard]] double limit_m() const noexcept;
    [[nodiscard]] double occupied_limit_m() const noexcept { return occupied_.limit_m; }
    [[nodiscard]] double unknown_limit_m() const noexcept { return unknown_.limit_m; }

    [[nodiscard]] Found occupied() const noexcept { return occupied_.found; }
    [[nodiscard]] Found unknown() const noexcept { return unknown_.found; }
    /// True if some of the space within reach lies outside the octree.
    [[nodiscard]] bool is_outside() const noexcept { return is_outside_; }

  private:
    static constexpr double kNever = -std::numeric_limits<double>::infinity();

    /// The nearest voxel of a state so far, and the distance within which another voxel can replace it.
    struct Nearest {
        Found found;
        double reach_m = 0.0;
        double limit_m = 0.0;
    };

    [[nodiscard]] bool is_surely_beyond(const VoxelCube& cube, double limit_m) const {
        return segment_.is_surely_beyond(centre_of(cube, resolution_m_), half_edge_of(cube, resolution_m_),
                                         limit_m + 4.0 * kDistanceStep_m);
    }
    [[nodiscard]] double distance_to(const VoxelCube& cube) const;
    [[nodiscard]] bool is_done() const;

    void look(const BrickTree::Space& space);
    void look_into(const VoxelCube& cube, const BrickView& bricks);
    void look_into_brick(const VoxelCube& brick, const BrickValues& values);
    /// True if some of these voxels of the word can change the result.
    [[nodiscard]] bool is_near(const Nearest& nearest, const VoxelCube& word, std::uint64_t voxels) const {
        return voxels != 0 && nearest.limit_m != kNever && !is_surely_beyond(word, nearest.limit_m);
    }
    void take_some(Nearest& nearest, const VoxelCube& word, std::uint64_t voxels);
    void take_each(Nearest& nearest, const VoxelCube& word, std::uint64_t voxels);
    [[nodiscard]] std::uint64_t facing(const VoxelCube& word, std::uint64_t voxels) const;
    void take(Nearest& nearest, VoxelCube cube);
    [[nodiscard]] VoxelCube nearest_eighth(const VoxelCube& cube, double& steps) const;

    const FusedMap& map_;
    double resolution_m_;
    SegmentToCubes segment_;
    Eigen::Vector3d lowest_;  ///< of the segment, along each axis
    Eigen::Vector3d highest_;
    SearchFor wanted_;
    bool is_outside_ = false;
    bool meets_octree_ = false;
    KeyBox box_;
    Nearest occupied_;
    Nearest unknown_;
};

}  // namespace octoskin
