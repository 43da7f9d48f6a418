// Where the camera was: the poses of a data set, and those between them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/tum/data_set_files.hpp"
#include "host/io/tum/data_set_lines.hpp"
#include "host/io/tum/line_file.hpp"

namespace octoskin::tum {

/// What became of the lines, or of the files of one pose each.
struct PoseCounts {
    std::uint64_t in = 0;
    std::uint64_t used = 0;
    std::uint64_t no_pose = 0;   ///< that say that none is known then, or are not there
    std::uint64_t repeated = 0;  ///< left out, as one above has their time
    BadLines bad;
    std::uint64_t unordered = 0;               ///< of all: earlier than the one above; they are put in order
    std::optional<DepthSourceError> disorder;  ///< the first of them
};

/// A pose so near to an instant is that of it. Programs that keep seconds of today as a double move them by
/// 0.2 us; a camera at 1 m/s covers 1 um meanwhile.
inline constexpr Nanoseconds kSameInstant{1'000};

class Trajectory {
  public:
    /// `gap_max`: between poses farther apart there is none. Errors name the file, and the line if not one
    /// has a pose.
    [[nodiscard]] static Result<Trajectory, DepthSourceError> read(const FilePlace& file, Nanoseconds gap_max,
                                                                   CameraAxes axes = CameraAxes::y_down);
    /// One file of a pose each, as `frames` name them, at the times of their images.
    [[nodiscard]] static Trajectory read_frames(const NamedFolder& folder,
                                                const std::vector<NumberedFrame>& frames,
                                                Nanoseconds gap_max);

    /// T_map_camera: position linear, orientation along the shorter arc. Empty before the first pose, after
    /// the last, where the poses about `instant` are over `gap_max` apart, and where one of them says that
    /// none is known. O(log poses).
    [[nodiscard]] std::optional<Eigen::Isometry3d> at(HostTime instant) const;
    /// How far the poses about `instant` are apart; empty before the first and after the last.
    [[nodiscard]] std::optional<Nanoseconds> gap_about(HostTime instant) const;
    [[nodiscard]] Nanoseconds gap_max() const noexcept { return gap_max_; }

    [[nodiscard]] const PoseCounts& counts() const noexcept { return counts_; }

  private:
    explicit Trajectory(Nanoseconds gap_max) : gap_max_(gap_max) {}
    [[nodiscard]] std::vector<PoseLine>::const_iterator from(HostTime instant) const;
    /// Within kSameInstant, the nearest; null if there is none.
    [[nodiscard]] const PoseLine* beside(HostTime instant) const;
    void put_in_order();

    Nanoseconds gap_max_;
    std::vector<PoseLine> poses_;
    PoseCounts counts_;
};

}  // namespace octoskin::tum
