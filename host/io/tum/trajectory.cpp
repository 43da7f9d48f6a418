#include "host/io/tum/trajectory.hpp"

#include <algorithm>

#include "host/io/tum/line_file.hpp"

namespace octoskin::tum {
namespace {

Eigen::Isometry3d between(const PoseLine& before, const PoseLine& after, HostTime instant) {
    const double part = static_cast<double>((instant - before.at).count()) /
                        static_cast<double>((after.at - before.at).count());
    const Eigen::Quaterniond q_before(before.T_map_camera.linear());
    const Eigen::Quaterniond q_after(after.T_map_camera.linear());
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    T_map_camera.linear() = q_before.slerp(part, q_after).normalized().toRotationMatrix();
    T_map_camera.translation() =
        (1.0 - part) * before.T_map_camera.translation() + part * after.T_map_camera.translation();
    return T_map_camera;
}

}  // namespace

Result<Trajectory, DepthSourceError> Trajectory::read(const FilePlace& file) {
    Trajectory trajectory;
    std::vector<PoseLine>& poses = trajectory.poses_;
    const auto take = [&trajectory, &poses](std::uint64_t, std::string_view line) -> Status<std::string> {
        const auto pose = parse_pose_line(line);
        if (!pose) return unexpected(pose.error());
        if (!poses.empty() && pose->at < poses.back().at)
            return unexpected(std::string("its time is before that of the pose above it"));
        const bool is_repeated = !poses.empty() && pose->at == poses.back().at;
        trajectory.repeated_ += is_repeated ? 1U : 0U;
        if (!is_repeated) poses.push_back(*pose);
        return Done{};
    };
    if (const auto done = read_lines(file, take); !done) return unexpected(done.error());
    return trajectory;
}

std::optional<Eigen::Isometry3d> Trajectory::at(HostTime instant) const {
    const auto after = std::lower_bound(poses_.begin(), poses_.end(), instant,
                                        [](const PoseLine& pose, HostTime time) { return pose.at < time; });
    if (after == poses_.end()) return std::nullopt;
    if (after->at == instant) return after->T_map_camera;
    if (after == poses_.begin() || after->at - std::prev(after)->at > kPoseGapMax) return std::nullopt;
    return between(*std::prev(after), *after, instant);
}

}  // namespace octoskin::tum
