#include "host/io/tum/trajectory.hpp"

#include <algorithm>
#include <iterator>

namespace octoskin::tum {
namespace {

Eigen::Isometry3d between(const PoseLine& before, const PoseLine& after, HostTime instant) {
    const double part = static_cast<double>((instant - before.at).count()) /
                        static_cast<double>((after.at - before.at).count());
    const Eigen::Quaterniond q_before(before.T_map_camera->linear());
    const Eigen::Quaterniond q_after(after.T_map_camera->linear());
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    T_map_camera.linear() = q_before.slerp(part, q_after).normalized().toRotationMatrix();
    T_map_camera.translation() =
        (1.0 - part) * before.T_map_camera->translation() + part * after.T_map_camera->translation();
    return T_map_camera;
}

/// In a left-handed data set the y axes of camera and map point up. Inverting y in both makes the motion one
/// of right-handed frames.
Eigen::Isometry3d with_y_down(const Eigen::Isometry3d& T_map_camera) {
    const Eigen::DiagonalMatrix<double, 3> turn(1.0, -1.0, 1.0);
    Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
    turned.linear() = turn * T_map_camera.linear() * turn;
    turned.translation() = turn * T_map_camera.translation();
    return turned;
}

}  // namespace

Result<Trajectory, Error> Trajectory::read(const FilePlace& file, Nanoseconds gap_max, CameraAxes axes) {
    Trajectory trajectory(gap_max);
    PoseCounts& counts = trajectory.counts_;
    std::vector<PoseLine>& poses = trajectory.poses_;
    const auto take = [&](std::uint64_t number, std::string_view line) -> Status<std::string> {
        auto pose = parse_pose_line(line);
        if (!pose) return unexpected(pose.error());
        if (axes == CameraAxes::y_up && pose->T_map_camera)
            pose->T_map_camera = with_y_down(*pose->T_map_camera);
        if (!poses.empty() && pose->at < poses.back().at && counts.unordered++ == 0)
            counts.disorder = line_error(
                file.shown(), number, {ErrorCode::bad_value, "its time is before that of the pose above it"});
        poses.push_back(*pose);
        return Done{};
    };
    auto bad = read_lines(file, take);
    if (!bad) return unexpected(bad.error());
    if (poses.empty() && bad->first) return unexpected(*bad->first);
    counts.bad = std::move(*bad);
    trajectory.put_in_order();
    return trajectory;
}

Trajectory Trajectory::read_frames(const NamedFolder& folder, const std::vector<NumberedFrame>& frames,
                                   Nanoseconds gap_max) {
    Trajectory trajectory(gap_max);
    for (const NumberedFrame& frame : frames) {
        if (!frame.has_pose) {
            trajectory.poses_.push_back({frame.captured, std::nullopt});
            continue;
        }
        const FilePlace file(folder, frame.pose);
        const auto text = read_small_file(file);
        const auto pose = text ? parse_pose_matrix(*text) : unexpected(std::string());
        if (pose) {
            trajectory.poses_.push_back({frame.captured, *pose});
        } else {
            trajectory.counts_.bad.add(text ? in_file({ErrorCode::bad_syntax, pose.error()}, file.shown())
                                            : text.error());
        }
    }
    trajectory.put_in_order();
    return trajectory;
}

void Trajectory::put_in_order() {
    const auto is_before = [](const PoseLine& a, const PoseLine& b) { return a.at < b.at; };
    const auto is_same = [](const PoseLine& a, const PoseLine& b) { return a.at == b.at; };
    const std::size_t read = poses_.size();
    std::ranges::stable_sort(poses_, is_before);
    poses_.erase(std::unique(poses_.begin(), poses_.end(), is_same), poses_.end());
    counts_.in = read + counts_.bad.count;
    counts_.repeated = read - poses_.size();
    counts_.used = static_cast<std::uint64_t>(
        std::ranges::count_if(poses_, [](const PoseLine& pose) { return pose.T_map_camera.has_value(); }));
    counts_.no_pose = poses_.size() - counts_.used;
}

std::vector<PoseLine>::const_iterator Trajectory::from(HostTime instant) const {
    return std::lower_bound(poses_.begin(), poses_.end(), instant,
                            [](const PoseLine& pose, HostTime time) { return pose.at < time; });
}

const PoseLine* Trajectory::beside(HostTime instant) const {
    const auto after = from(instant);
    const PoseLine* beside = nullptr;
    if (after != poses_.end() && after->at - instant <= kSameInstant) beside = &*after;
    if (after == poses_.begin()) return beside;
    const PoseLine& before = *std::prev(after);
    const bool is_nearer = beside == nullptr || instant - before.at < beside->at - instant;
    return instant - before.at <= kSameInstant && is_nearer ? &before : beside;
}

std::optional<Nanoseconds> Trajectory::gap_about(HostTime instant) const {
    if (beside(instant) != nullptr) return Nanoseconds{0};
    const auto after = from(instant);
    if (after == poses_.end() || after == poses_.begin()) return std::nullopt;
    return after->at - std::prev(after)->at;
}

std::optional<Eigen::Isometry3d> Trajectory::at(HostTime instant) const {
    if (const PoseLine* const pose = beside(instant)) return pose->T_map_camera;
    const auto gap = gap_about(instant);
    if (!gap || *gap > gap_max_) return std::nullopt;
    const auto after = from(instant);
    const PoseLine& before = *std::prev(after);
    const bool is_known = before.T_map_camera && after->T_map_camera;
    return is_known ? std::optional(between(before, *after, instant)) : std::nullopt;
}

}  // namespace octoskin::tum
