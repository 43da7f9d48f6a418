#include "host/core/pipeline/robot_tracker.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

namespace octoskin {

Result<RobotTracker, RobotModelFault> RobotTracker::build(const HostRig& rig, RobotModel robot,
                                                          const JointHistoryConfig& config) {
    Result<RobotBody, RobotModelFault> body = RobotBody::build(rig.body, robot);
    if (!body) {
        return unexpected(body.error());
    }
    return RobotTracker(rig, std::move(robot), std::move(body).value(), config);
}

RobotTracker::RobotTracker(const HostRig& rig, RobotModel robot, RobotBody body,
                           const JointHistoryConfig& config)
    : robot_(std::move(robot)), body_(std::move(body)), config_(config) {
    std::size_t first = 0;
    for (const HostJointSource& source : rig.joint_sources) {
        const std::size_t count = source.joints.size();
        sources_.push_back({first, count, JointHistory(robot_.limits().subspan(first, count), config)});
        first += count;
    }
    assert(first == robot_.joint_count());
    pose_.T_base_link.resize(robot_.link_count());
}

Status<JointReason> RobotTracker::add(const JointMeasurement& joints) {
    Source& source = sources_.at(joints.source);
    const auto added = source.history.add(joints.sampled, std::span(joints.position_rad).first(source.count));
    if (added) {
        return Done{};
    }
    return unexpected(added.error() == JointRejection::out_of_order ? JointReason::out_of_order
                                                                    : JointReason::out_of_limits);
}

void RobotTracker::forget() noexcept {
    for (Source& source : sources_) source.history.forget();
}

bool RobotTracker::is_settled(HostTime instant) const noexcept {
    std::optional<HostTime> newest;
    for (const Source& source : sources_) newest = std::max(newest, source.history.newest());
    const auto is_settled = [&](const Source& source) {
        if (source.history.is_settled(instant)) return true;
        const auto own = source.history.newest();
        // Its next sample is unlikely to bridge the instant, even if it arrives late.
        return newest && *newest - own.value_or(instant) > 2 * config_.bracket_max;
    };
    return newest && std::ranges::all_of(sources_, is_settled);
}

const RobotPose* RobotTracker::at(HostTime instant) {
    std::array<double, kJointsMax> position{};
    const std::size_t count = robot_.joint_count();
    const JointSet unknown = look_up(instant, position);
    const bool is_any_known =
        std::ranges::any_of(sources_, [&](const Source& source) { return (source.joints() & unknown) == 0; });
    if (!is_any_known) return nullptr;
    note_unknown(unknown);
    robot_.forward(std::span(position).first(count), pose_.T_base_link);
    pose_.unknown = unknown;
    if (unknown == 0) {
        body_.pose(pose_.T_base_link, pose_.body_base);
    } else {
        body_.pose(robot_, pose_.T_base_link, unknown, pose_.body_base);
    }
    return &pose_;
}

JointSet RobotTracker::look_up(HostTime instant, std::span<double> position) {
    JointSet unknown = 0;
    for (Source& source : sources_) {
        const auto found = source.history.at(instant);
        if (found) {
            std::ranges::copy(found->span(), position.subspan(source.first).begin());
            continue;
        }
        if (found.error() == JointLookup::gap) source.note_gap(source.history.gap_about(instant));
        unknown |= source.joints();
    }
    return unknown;
}

void RobotTracker::note_unknown(JointSet unknown) {
    for (std::size_t joint = 0; unknown != 0; ++joint, unknown >>= 1)
        times_unknown_.at(joint) += unknown & 1U;
}

JointSet RobotTracker::Source::joints() const noexcept {
    JointSet joints = 0;
    for (std::size_t i = first; i < first + count; ++i) joints |= JointSet{1} << i;
    return joints;
}

void RobotTracker::Source::note_gap(const JointGap& gap) {
    constexpr Nanoseconds kRow{3'000'000'000};
    if (!newest_gap || gap.from - newest_gap->from > kRow) gaps_in_a_row = 0;
    if (!newest_gap || gap.from != newest_gap->from) ++gaps_in_a_row;
    newest_gap = gap;
}

std::optional<RobotTracker::NewestPosition> RobotTracker::newest() const {
    NewestPosition newest;
    for (const Source& source : sources_) {
        const auto sampled = source.history.newest();
        if (!sampled) return std::nullopt;
        newest.oldest = newest.position.empty() ? *sampled : std::min(newest.oldest, *sampled);
        const auto position = source.history.at(*sampled).value();
        newest.position.insert(newest.position.end(), position.span().begin(), position.span().end());
    }
    return newest;
}

void RobotTracker::for_each_sample(const std::function<void(const JointMeasurement&)>& visit) const {
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        sources_[i].history.for_each([&](HostTime sampled, std::span<const double> position) {
            JointMeasurement joints{.sampled = sampled, .source = static_cast<std::uint8_t>(i)};
            std::ranges::copy(position, joints.position_rad.begin());
            visit(joints);
        });
    }
}

}  // namespace octoskin
