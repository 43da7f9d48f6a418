// Watches one voxel while a map is made, and keeps everything that changed it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/pipeline/commit.hpp"

namespace octoskin {

/// One reading or depth frame that had a term for the voxel.
struct Contribution {
    BeamSource source;        ///< node 0: the camera
    std::uint64_t frame = 0;  ///< of the camera: how many frames were integrated before it
    HostTime captured;
    std::optional<double> range_m;                            ///< of a reading with a target
    Eigen::Vector3d p_map_sensor = Eigen::Vector3d::Zero();   ///< of a reading: where its sensor was, metres
    Eigen::Vector3d direction_map = Eigen::Vector3d::Zero();  ///< and where it looked
    float term = 0.0F;                                        ///< log-odds that it asked for
    float before = 0.0F;                                      ///< the voxel's log-odds; 0 if it was unknown
    float after = 0.0F;                                       ///< clamped
    /// What it did. Exact: their sum is the voxel's log-odds, less that of the begin, and less what was
    /// forgotten (`Forgotten`).
    [[nodiscard]] double change() const { return static_cast<double>(after) - static_cast<double>(before); }
};

/// All contributions of one source.
struct SourceShare {
    std::uint64_t hits = 0;    ///< terms above 0
    std::uint64_t misses = 0;  ///< terms below 0
    double change = 0.0;       ///< log-odds, clamping included
    double kept = 0.0;         ///< of that, since the voxel was last forgotten
    HostTime first;
    HostTime last;
};

/// The voxel expired: no sensor had confirmed it for `age.unknown_after_s`.
struct Forgotten {
    std::uint64_t times = 0;
    double change = 0.0;           ///< log-odds, of all times together
    std::optional<HostTime> last;  ///< empty: while a saved map waited for its first measurement
    bool is_last = false;          ///< nothing touched the voxel since
};

class VoxelWitness final : public CommitListener {
  public:
    /// Of the contributions the newest `kept_max` are kept; the shares count all of them.
    VoxelWitness(VoxelKey key, const MapConfig& config, std::size_t kept_max)
        : key_(key), config_(config), kept_max_(kept_max) {}

    void on_begin(const FusedMap& map) override { begin_ = now_ = map.log_odds(key_); }
    void on_time(std::optional<HostTime> now, std::span<const FedMap> maps) override {
        if (const FusedMap* const map = find_map(maps, MapFeed::both)) on_older(now, *map);
    }
    void on_older(std::optional<HostTime> now, const FusedMap& map);
    void on_joints(const JointMeasurement&) override {}
    void on_reading(const RangeMeasurement& measurement, const Beam& beam,
                    std::span<const VoxelUpdate> updates) override;
    void on_depth(const DepthFrame& frame, const Evidence& terms) override;
    /// Where range sensors count hits and misses, terms do not simply add up: there the map is asked.
    void on_maps(std::span<const FedMap> maps) override {
        if (const FusedMap* const map = find_map(maps, MapFeed::both)) on_fused(*map);
    }
    void on_fused(const FusedMap& map);

    [[nodiscard]] VoxelKey key() const noexcept { return key_; }
    /// The voxel's log-odds in the map that this one goes on from; empty: unknown.
    [[nodiscard]] std::optional<float> begin() const noexcept { return begin_; }
    /// By the same arithmetic as the map's, but where that is asked; empty: unknown.
    [[nodiscard]] std::optional<float> log_odds() const noexcept { return now_; }
    /// What was there at the begin and every change since, added up: the voxel's log-odds, or 0 for unknown.
    [[nodiscard]] double sum() const;
    [[nodiscard]] const std::deque<Contribution>& newest() const noexcept { return newest_; }
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    [[nodiscard]] const std::map<BeamSource, SourceShare>& shares() const noexcept { return shares_; }
    [[nodiscard]] const Forgotten& forgotten() const noexcept { return forgotten_; }

  private:
    void take(Contribution contribution, std::span<const VoxelUpdate> updates);

    VoxelKey key_;
    MapConfig config_;
    std::optional<float> begin_;
    std::optional<float> now_;
    std::size_t kept_max_;
    std::uint64_t depth_frames_ = 0;
    std::uint64_t count_ = 0;
    bool is_newest_of_commit_ = false;  ///< newest_.back() is of the reading or frame that came last
    std::deque<Contribution> newest_;
    std::map<BeamSource, SourceShare> shares_;
    Forgotten forgotten_;
};

}  // namespace octoskin
