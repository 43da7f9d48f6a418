// The maps that are built at the same time: from the camera, from the range sensors, from both.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

struct MapChoice {
    bool depth = true;
    bool proximity = true;
    bool fused = true;
};

class MapSet {
  public:
    MapSet(const MapConfig& config, const MapChoice& choice);

    /// In place of the empty fused map, which was chosen (asserted); of the same resolution (asserted).
    void begin_with(FusedMap fused);

    /// Other limits for the fused map, which was chosen (asserted), at the same resolution (asserted).
    void limit_fused(const MapConfig& config);

    /// What range sensors counted in any map becomes log-odds like any other (FusedMap::forget_counts).
    void forget_counts() noexcept;

    /// The fused map, which was chosen (asserted), for another set to begin with; nothing may be added after.
    [[nodiscard]] FusedMap take_fused();

    /// When what is added next was measured (FusedMap::go_on).
    void go_on(HostTime now) noexcept;

    /// A clock was set, nothing has become older (FusedMap::leap).
    void leap(Nanoseconds by) noexcept;

    /// To `depth` and `fused`.
    void add_depth(const DepthTerms& terms);
    /// To `proximity` and `fused`.
    void add_proximity(std::span<const VoxelUpdate> updates);
    void add_proximity(const ConeVoxels& cone, const ConeModel& model, Blame blame);
    /// The same; the answer is by how much each log-odds of `fused`, if it was chosen, changed.
    [[nodiscard]] std::vector<VoxelUpdate> changes_of_proximity(const ConeVoxels& cone,
                                                                const ConeModel& model, Blame blame);

    /// FusedMap::mark in each map in which the voxel of the range's end, `p_map`, is not occupied: where it
    /// is, it explains the range. `changes`: of `fused`; may be null.
    void mark(const ConeVoxels& cone, const Eigen::Vector3d& p_map, float hits,
              std::vector<VoxelUpdate>* changes);
    /// Whether that would do nothing.
    [[nodiscard]] bool is_marked(const Eigen::Vector3d& p_map) const noexcept;
    /// FusedMap::forget_weak_hits, likewise.
    void forget_weak_hits(const ConeVoxels& cone, std::vector<VoxelUpdate>* changes);
    /// FusedMap::clear, likewise.
    void clear(const ConeVoxels& cone, const std::function<bool(VoxelKey)>& is_ranged,
               std::vector<VoxelUpdate>* changes);

    /// Null if it was not chosen.
    [[nodiscard]] const FusedMap* depth() const noexcept { return depth_ ? &*depth_ : nullptr; }
    [[nodiscard]] const FusedMap* proximity() const noexcept { return proximity_ ? &*proximity_ : nullptr; }
    [[nodiscard]] const FusedMap* fused() const noexcept { return fused_ ? &*fused_ : nullptr; }

  private:
    void count(const ConeVoxels& cone, const ConeModel& model, Blame blame,
               std::vector<VoxelUpdate>* changes);

    std::optional<FusedMap> depth_;
    std::optional<FusedMap> proximity_;
    std::optional<FusedMap> fused_;
};

}  // namespace octoskin
