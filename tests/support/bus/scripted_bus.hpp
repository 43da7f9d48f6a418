// A scripted bus: converts messages at host times to frames with times of the nodes' clocks, in the order of
// arrival.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/wire/messages.hpp"
#include "host/core/pipeline/can_source.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin::test {

/// Host time 0 is this wall time.
inline constexpr std::int64_t kWallOffsetNs = 1'600'000'000'000'000'000;

[[nodiscard]] HostTime host_at(double seconds);
[[nodiscard]] WallTime wall_at(double seconds);

class ScriptedBus {
  public:
    /// Without it a node's clock reads host time in microseconds.
    void set_clock(wire::NodeId node, std::uint32_t offset_us, double drift = 0.0);
    [[nodiscard]] NodeTime node_time(wire::NodeId node, double at_s) const;

    /// A frame that arrives at `at_s`.
    void send(double at_s, const wire::CanFrame& frame);
    void send(double at_s, const wire::Message& message, wire::NodeId node);
    /// SYNC at `at_s`, FOLLOW_UP 1 ms and the reports of `nodes` 2 ms later.
    void exchange(double at_s, const std::vector<wire::NodeId>& nodes);
    /// All pages of NODE_INFO, right for `node`.
    void info(double at_s, const HostNode& node, std::uint32_t build_id = 0);
    void heartbeat(double at_s, const HostNode& node);
    /// SENSOR_HEALTH of a sensor without faults, with this bound on the error of its capture times.
    void health(double at_s, wire::NodeId node, std::uint8_t sensor, std::uint8_t capture_bound_64us = 3);
    /// Four frames, the last one 0.4 ms after the sample.
    void joints(double sampled_s, wire::NodeId node, std::span<const double> position_rad);
    /// A classical RANGE frame, `delay_s` after its capture. Sequence: one more than the one before it of
    /// this sensor. Returns the reading as sent.
    wire::RangeReading range(double captured_s, wire::NodeId node, wire::RangeReading reading,
                             double delay_s = 0.015);

    /// In the order of arrival; frames of equal time in the order in which they were sent.
    [[nodiscard]] std::vector<StampedFrame> frames() const;

    /// Of the board behind a node id: 96 bits, made of the id.
    [[nodiscard]] static std::array<std::uint8_t, 12> uid_of(wire::NodeId node);

  private:
    struct Clock {
        std::uint32_t offset_us = 0;
        double drift = 0.0;
    };
    std::map<wire::NodeId, Clock> clocks_;
    std::uint8_t sync_sequence_ = 0;
    std::map<wire::NodeId, std::uint8_t> joint_sequence_;
    std::map<std::pair<wire::NodeId, std::uint8_t>, std::uint8_t> range_sequence_;
    std::vector<StampedFrame> frames_;
};

/// The frames of a script as a source.
class ScriptedSource final : public CanSource {
  public:
    explicit ScriptedSource(std::vector<StampedFrame> frames) : frames_(std::move(frames)) {}
    [[nodiscard]] Result<std::optional<StampedFrame>, Error> next() override {
        return next_ < frames_.size() ? std::optional(frames_[next_++]) : std::nullopt;
    }

  private:
    std::vector<StampedFrame> frames_;
    std::size_t next_ = 0;
};

}  // namespace octoskin::test
