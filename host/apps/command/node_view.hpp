// The latest messages of a node, and their text for people.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "common/wire/messages.hpp"
#include "host/apps/command/order.hpp"

namespace octoskin::commanding {

/// The pages of NODE_INFO.
struct InfoPages {
    std::optional<wire::InfoUidLow> uid_low;
    std::optional<wire::InfoUidHigh> uid_high;
    std::optional<wire::InfoIdentity> identity;
    std::optional<wire::InfoBuild> build;
    std::optional<wire::InfoCounters> counters;
    std::optional<wire::InfoTraffic> traffic;
    std::optional<wire::InfoFault> fault;

    void take(const wire::NodeInfo& page);
    [[nodiscard]] bool is_complete() const noexcept;
};

struct NodeView {
    std::optional<wire::Heartbeat> heartbeat;
    InfoPages info;
    std::array<std::optional<wire::SensorHealth>, wire::kAllSensors> sensors;

    [[nodiscard]] wire::NodeState state() const noexcept {
        return heartbeat ? heartbeat->state : wire::NodeState::starting;
    }
    [[nodiscard]] std::uint8_t sensor_count() const noexcept {
        return info.identity ? info.identity->sensor_count : std::uint8_t{0};
    }
    /// Whether `has` holds for at least one sensor of this command.
    template <class Predicate>
    [[nodiscard]] bool any_of(const wire::Command& command, const Predicate& has) const {
        for (std::uint8_t i = 0; i < sensor_count() && i < sensors.size(); ++i) {
            const bool is_meant = command.sensor == wire::kAllSensors || command.sensor == i;
            if (is_meant && has(sensors.at(i))) return true;
        }
        return false;
    }
};

/// "ranging; 4 sensors: 3 ranging, 1 absent (left: no_answer)"
[[nodiscard]] std::string state_text(const NodeView& view, const Order& order);
/// All of NODE_INFO, indented, one line per topic. Requires a complete view.
[[nodiscard]] std::string info_text(const NodeView& view, const Order& order);
/// Text if the node's configuration differs from the rig's; empty if it is the same or there is no rig.
[[nodiscard]] std::string difference_text(const NodeView& view, const Order& order);

}  // namespace octoskin::commanding
