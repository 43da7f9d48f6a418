// Where the camera was: the poses of groundtruth.txt, and those between them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/tum/data_set_lines.hpp"

namespace octoskin::tum {

/// Poses farther apart than this are not interpolated between: five periods of the benchmark's motion capture
/// at 100 Hz. A camera that accelerates at 5 m/s^2 leaves the straight line by 1.6 mm meanwhile.
inline constexpr Nanoseconds kPoseGapMax{50'000'000};

class Trajectory {
  public:
    /// Errors name file and line: no pose, or one before its predecessor. Of two with one time the first
    /// counts, see `repeated`.
    [[nodiscard]] static Result<Trajectory, DepthSourceError> read(const FilePlace& file);

    /// T_map_camera: position linear, orientation along the shorter arc. Empty before the first pose, after
    /// the last, and where the poses about `instant` are over kPoseGapMax apart. O(log poses).
    [[nodiscard]] std::optional<Eigen::Isometry3d> at(HostTime instant) const;

    [[nodiscard]] std::size_t poses() const noexcept { return poses_.size(); }
    /// Lines that were left out, as the pose above them has their time.
    [[nodiscard]] std::uint64_t repeated() const noexcept { return repeated_; }

  private:
    std::vector<PoseLine> poses_;
    std::uint64_t repeated_ = 0;
};

}  // namespace octoskin::tum
