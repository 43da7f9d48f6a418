// The trace of one voxel while a map is made: everything that changes the voxel.
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

/// The source of the frames of the rig's camera with this index: node 0, and the index as the sensor.
[[nodiscard]] constexpr BeamSource source_of_camera(std::size_t camera) {
    return {0, static_cast<std::uint8_t>(camera), 0};
}
[[nodiscard]] constexpr bool is_camera(const BeamSource& source) {
    return source.node_id == 0;
}

/// A reading or depth frame with a term for the voxel.
struct Contribution {
    BeamSource source;        ///< of a camera: see source_of_camera
    std::uint64_t frame = 0;  ///< for a camera: how many of its frames were integrated before this one
    HostTime captured;
    std::optional<double> range_m;  ///< for a reading with a target
    Eigen::Vector3d p_map_sensor =
        Eigen::Vector3d::Zero();  ///< for a reading: origin of the sensor, map frame, metres
    Eigen::Vector3d direction_map = Eigen::Vector3d::Zero();  ///< for a reading: viewing direction, map frame
    float term = 0.0F;                                        ///< log-odds term of this contribution
    float before = 0.0F;  ///< log-odds of the voxel before it; 0 if unknown
    float after = 0.0F;   ///< log-odds of the voxel after it, clamped
    /// The change of the voxel. Exact: the sum of all changes is the log-odds of the voxel, less those at the
    /// beginning, and less what expired (`Forgotten`).
    [[nodiscard]] double change() const { return static_cast<double>(after) - static_cast<double>(before); }
};

/// All contributions of one source.
struct SourceShare {
    std::uint64_t hits = 0;    ///< terms above 0
    std::uint64_t misses = 0;  ///< terms below 0
    double change = 0.0;       ///< log-odds, after clamping
    double kept = 0.0;         ///< part of `change` since the voxel last expired
    HostTime first;
    HostTime last;
};

/// The voxel became unknown: no sensor had confirmed it for `age.unknown_after_s`, or a measurement took back
/// that it is occupied (EvidenceRule::weaken).
struct Forgotten {
    std::uint64_t times = 0;
    double change = 0.0;           ///< log-odds, sum over all expiries
    std::optional<HostTime> last;  ///< empty: while a saved map waited for its first measurement
    bool is_last = false;          ///< nothing has changed the voxel since
};

class VoxelTrace final : public CommitListener {
  public:
    /// Keeps the newest `kept_max` contributions; the shares count all of them.
    VoxelTrace(VoxelKey key, const MapConfig& config, std::size_t kept_max)
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
    /// In a map that counts hits and misses of range sensors, terms do not simply add up: the log-odds are
    /// read from the map.
    void on_maps(std::span<const FedMap> maps) override {
        if (const FusedMap* const map = find_map(maps, MapFeed::both)) on_fused(*map);
    }
    void on_fused(const FusedMap& map);

    [[nodiscard]] VoxelKey key() const noexcept { return key_; }
    /// The log-odds of the voxel in the map from which this one continues; empty: unknown.
    [[nodiscard]] std::optional<float> begin() const noexcept { return begin_; }
    /// Computed with the same arithmetic as in the map, or read from the map where terms do not add up;
    /// empty: unknown.
    [[nodiscard]] std::optional<float> log_odds() const noexcept { return now_; }
    /// The initial log-odds and every change since, added up: the log-odds of the voxel, or 0 for unknown.
    [[nodiscard]] double sum() const;
    [[nodiscard]] const std::deque<Contribution>& newest() const noexcept { return newest_; }
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    [[nodiscard]] const std::map<BeamSource, SourceShare>& shares() const noexcept { return shares_; }
    [[nodiscard]] const Forgotten& forgotten() const noexcept { return forgotten_; }

  private:
    void forget(std::optional<HostTime> now);
    void take(Contribution contribution, std::span<const VoxelUpdate> updates);

    VoxelKey key_;
    MapConfig config_;
    std::optional<float> begin_;
    std::optional<float> now_;
    std::size_t kept_max_;
    std::map<std::uint8_t, std::uint64_t> depth_frames_;  ///< by camera
    std::optional<HostTime> captured_;                    ///< of the newest reading or frame
    std::uint64_t count_ = 0;
    bool is_newest_of_commit_ = false;  ///< newest_.back() belongs to the latest reading or frame
    std::deque<Contribution> newest_;
    std::map<BeamSource, SourceShare> shares_;
    Forgotten forgotten_;
};

}  // namespace octoskin
