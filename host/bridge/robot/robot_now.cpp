#include "host/bridge/robot/robot_now.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace octoskin::bridge {

Result<RobotNow, std::string> RobotNow::of(const RobotFacts& robot) {
    std::vector<std::string> moved;
    for (const JointSourceFacts& source : robot.joint_sources)
        moved.insert(moved.end(), source.joints.begin(), source.joints.end());
    auto model = RobotModel::build(robot.base_link, robot.joints, moved);
    if (!model)
        return unexpected(std::string(describe(model.error().error)) + " (" + model.error().element + ")");
    return RobotNow(robot, std::move(model).value());
}

RobotNow::RobotNow(const RobotFacts& robot, RobotModel model)
    : root_link_(robot.root_link),
      body_(robot.body),
      T_map_root_(robot.T_root_map.inverse()),
      T_map_base_(robot.T_root_map.inverse() * robot.T_root_base),
      model_(std::move(model)),
      first_of_source_{0},
      has_source_(robot.joint_sources.size(), false),
      position_(model_.joint_count(), 0.0),
      T_base_link_(model_.link_count(), Eigen::Isometry3d::Identity()) {
    for (const JointSourceFacts& source : robot.joint_sources)
        first_of_source_.push_back(first_of_source_.back() + source.joints.size());
    update();
}

void RobotNow::take(std::size_t source, const std::vector<double>& position) {
    if (source >= has_source_.size()) return;
    const std::size_t first = first_of_source_[source];
    const bool is_whole = position.size() == first_of_source_[source + 1] - first;
    if (!is_whole || !std::ranges::all_of(position, [](double q) { return std::isfinite(q); })) return;
    std::ranges::copy(position, position_.begin() + static_cast<std::ptrdiff_t>(first));
    has_source_[source] = true;
    update();
}

void RobotNow::update() {
    model_.forward(position_, T_base_link_);
}

bool RobotNow::is_known() const noexcept {
    return std::ranges::all_of(has_source_, [](bool has) { return has; });
}

std::optional<Eigen::Isometry3d> RobotNow::T_map_frame(const std::string& frame) const {
    if (frame == root_link_) return T_map_root_;
    const auto link = model_.find_link(frame);
    if (!link) return std::nullopt;
    if (!is_known() && model_.joints_above(*link) != JointSet{}) return std::nullopt;
    return T_map_base_ * T_base_link_[*link];
}

std::vector<PosedCapsule> RobotNow::body_map() const {
    std::vector<PosedCapsule> posed;
    if (!is_known()) return posed;
    for (const LinkCapsule& capsule : body_) {
        const auto T = T_map_frame(capsule.link);
        if (T) posed.push_back({*T * capsule.p_link_a, *T * capsule.p_link_b, capsule.radius_m});
    }
    return posed;
}

}  // namespace octoskin::bridge
