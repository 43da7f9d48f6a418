// The poses of a data set's camera, and interpolation between them.
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

/// Counts of the lines, or of the pose files.
struct PoseCounts {
    std::uint64_t in = 0;
    std::uint64_t used = 0;
    std::uint64_t no_pose = 0;   ///< marked as unknown, or missing files
    std::uint64_t repeated = 0;  ///< dropped, because a previous one has the same time
    BadLines bad;
    std::uint64_t unordered = 0;    ///< of all: with a time before the previous one; they are sorted
    std::optional<Error> disorder;  ///< the first of them
};

/// A pose within this time of an instant is used without interpolation. Programs that store present-day
/// seconds as a double shift them by 0.2 us; a camera at 1 m/s moves 1 um in this time.
inline constexpr Nanoseconds kSameInstant{1'000};

class Trajectory {
  public:
    /// `gap_max`: no interpolation between poses farther apart. Errors name the file, and the line if no line
    /// has a pose.
    [[nodiscard]] static Result<Trajectory, Error> read(const FilePlace& file, Nanoseconds gap_max,
                                                        CameraAxes axes = CameraAxes::y_down);
    /// The pose files named in `frames`, one each, at the times of their images.
    [[nodiscard]] static Trajectory read_frames(const NamedFolder& folder,
                                                const std::vector<NumberedFrame>& frames,
                                                Nanoseconds gap_max);

    /// T_map_camera: linear in position, orientation along the shorter arc. Empty before the first pose,
    /// after the last, if the poses around `instant` are more than `gap_max` apart, or if one of them is
    /// marked as unknown. O(log poses).
    [[nodiscard]] std::optional<Eigen::Isometry3d> at(HostTime instant) const;
    /// The distance between the poses around `instant`; empty before the first and after the last.
    [[nodiscard]] std::optional<Nanoseconds> gap_about(HostTime instant) const;
    [[nodiscard]] Nanoseconds gap_max() const noexcept { return gap_max_; }

    [[nodiscard]] const PoseCounts& counts() const noexcept { return counts_; }

  private:
    explicit Trajectory(Nanoseconds gap_max) : gap_max_(gap_max) {}
    [[nodiscard]] std::vector<PoseLine>::const_iterator from(HostTime instant) const;
    /// The nearest one within kSameInstant; null if there is none.
    [[nodiscard]] const PoseLine* beside(HostTime instant) const;
    void put_in_order();

    Nanoseconds gap_max_;
    std::vector<PoseLine> poses_;
    PoseCounts counts_;
};

}  // namespace octoskin::tum
