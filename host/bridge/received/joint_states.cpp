#include "host/bridge/received/joint_states.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/bridge/published/ros_values.hpp"
#include "host/bridge/robot/first_names.hpp"

namespace octoskin::bridge {

bool JointStates::has_local_source() const noexcept {
    return std::ranges::any_of(sources_, &JointSourceFacts::is_local);
}

std::string JointStates::local_joints() const {
    std::vector<std::string> names;
    for (const JointSourceFacts& source : sources_)
        if (source.is_local) names.insert(names.end(), source.joints.begin(), source.joints.end());
    return first_names(names);
}

bool JointStates::takes_names(const ros::sensor_msgs::JointState& message, Positions& positions) {
    if (message.name.size() != message.position.size()) {
        ++counts_.wrong_size;
        return false;
    }
    for (std::size_t i = 0; i < message.name.size(); ++i) {
        const bool is_ours = std::ranges::any_of(sources_, [&](const JointSourceFacts& source) {
            return source.is_local &&
                   std::ranges::find(source.joints, message.name[i]) != source.joints.end();
        });
        if (!is_ours) continue;
        if (!std::isfinite(message.position[i])) {
            ++counts_.not_finite;
            return false;
        }
        if (!positions.emplace(message.name[i], message.position[i]).second) {
            ++counts_.repeated_name;
            return false;
        }
    }
    if (positions.empty()) {
        ++counts_.other_joints;
        other_names_ = first_names(message.name);
    }
    return !positions.empty();
}

std::vector<std::size_t> JointStates::whole_sources(const Positions& positions) {
    std::vector<std::size_t> whole;
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        if (!sources_[i].is_local) continue;
        std::vector<std::string> missing;
        for (const std::string& joint : sources_[i].joints)
            if (!positions.contains(joint)) missing.push_back(joint);
        if (missing.size() == sources_[i].joints.size()) continue;
        if (!missing.empty()) {
            missing_ = fmt::format("{}", fmt::join(missing, ", "));
            ++counts_.partial;
            return {};
        }
        whole.push_back(i);
    }
    return whole;
}

/// With two publishers of one joint, which of them is right cannot be decided.
bool JointStates::has_rival(std::uint64_t publisher, const std::vector<std::size_t>& sources, HostTime now) {
    if (!publishers_.contains(publisher) && publishers_.size() >= kPublishersMax) return true;
    Publisher& own = publishers_[publisher];
    own.sent.resize(sources_.size(), HostTime{std::numeric_limits<std::int64_t>::min() / 2});
    for (const std::size_t source : sources) own.sent[source] = now;
    for (const auto& [other, state] : publishers_) {
        if (other == publisher) continue;
        for (const std::size_t source : sources)
            if (source < state.sent.size() && now - state.sent[source] < kAtOnce) return true;
    }
    return false;
}

std::vector<std::string> JointStates::take(const std::vector<Received>& messages) {
    std::vector<std::string> lines;
    for (auto one = messages.begin(); one != messages.end(); ++one) {
        const bool is_stamped = wall_time_of(one->message.header.stamp).ns != 0;
        const bool has_newer = std::any_of(one + 1, messages.end(), [one](const Received& later) {
            return later.publisher == one->publisher &&
                   later.arrival.monotonic - one->arrival.monotonic < kPeriodMin;
        });
        if (!is_stamped && has_newer) {
            ++counts_.received;
            ++counts_.too_frequent;
        } else if (auto line = take(one->message, one->publisher, one->arrival)) {
            lines.push_back(std::move(*line));
        }
    }
    return lines;
}

std::optional<std::string> JointStates::take(const ros::sensor_msgs::JointState& message,
                                             std::uint64_t publisher, const Arrival& arrival) {
    ++counts_.received;
    Positions positions;
    if (!takes_names(message, positions)) return std::nullopt;
    const std::vector<std::size_t> sources = whole_sources(positions);
    if (sources.empty()) return std::nullopt;
    std::erase_if(publishers_, [&](const auto& one) {
        return std::ranges::all_of(one.second.sent,
                                   [&](HostTime sent) { return arrival.monotonic - sent > 10 * kAtOnce; });
    });
    if (has_rival(publisher, sources, arrival.monotonic)) {
        ++counts_.second_sender;
        return std::nullopt;
    }
    const WallTime stamp = wall_time_of(message.header.stamp);
    const auto sampled = time_of_stamp(stamp, arrival);
    if (!sampled) {
        ++(sampled.error() == StampFault::ahead ? counts_.ahead : counts_.behind);
        stamp_age_ = Nanoseconds{arrival.wall.ns - stamp.ns};
        return std::nullopt;
    }
    Publisher& own = publishers_[publisher];
    const bool has_clock_gone_back = own.stamp.ns > arrival.wall.ns + kAheadMax.count();
    if (stamp.ns != 0 && stamp <= own.stamp && !has_clock_gone_back) {
        ++counts_.still;
        return std::nullopt;
    }
    own.stamp = stamp;
    const bool is_soon =
        own.forwarded && *sampled - *own.forwarded < kPeriodMin && *own.forwarded - *sampled < kAtOnce;
    if (is_soon) {
        ++counts_.too_frequent;
        return std::nullopt;
    }
    own.forwarded = *sampled;
    std::string line = fmt::format("{:.6f}", static_cast<double>(sampled->ns) * 1e-9);
    for (const std::size_t source : sources)
        for (const std::string& joint : sources_[source].joints)
            line += fmt::format(" {}={:.9g}", joint, positions.find(joint)->second);
    ++counts_.forwarded;
    return line;
}

}  // namespace octoskin::bridge
