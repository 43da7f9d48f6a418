// Ranges, frames and problems on their topics.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/bridge/outlets/outlet.hpp"
#include "host/bridge/robot/robot_facts.hpp"
#include "host/core/rig/sensor_id.hpp"
#include "host/io/watch/watch_frame.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

class SensorOutlets {
  public:
    /// Readings of one round arrive within this time.
    static constexpr Nanoseconds kRound{50'000'000};
    /// The errors of `on_robot` and of `open` name the topic. `prefix`: "/octoskin".
    [[nodiscard]] static Result<SensorOutlets, Error> open(TopicSink& sink, std::string prefix,
                                                           std::string map_frame);

    /// Also publishes these frames beside those of the sensors, from the next `on_robot` on.
    void change_other_frames(std::vector<ros::geometry_msgs::TransformStamped> frames) {
        other_frames_ = std::move(frames);
    }
    /// Opens a topic for each sensor and publishes the frames.
    [[nodiscard]] Status<Error> on_robot(const RobotFacts& robot, WallTime wall);
    void on_range(const watch::WatchedRange& range, HostTime now, WallTime captured);
    void on_status(const nlohmann::ordered_json& status) { status_ = status; }
    void on_lost(const std::string& why);
    /// What the bridge itself says, beside the daemon's problems.
    void change_notes(std::vector<ros::diagnostic_msgs::DiagnosticStatus> notes) {
        notes_ = std::move(notes);
    }

    /// Frames have the prefix of the topics without slashes: "/left/octoskin" gives "left_octoskin".
    [[nodiscard]] std::string frame_prefix() const;
    /// Sends what is due: problems once a second, points at the end of each round.
    void attend(HostTime now, WallTime wall);

    [[nodiscard]] std::vector<const Outlet*> outlets() const;

  private:
    SensorOutlets(TopicSink& sink, std::string prefix, std::string map_frame)
        : sink_(&sink), prefix_(std::move(prefix)), map_frame_(std::move(map_frame)) {}
    void end_round();

    TopicSink* sink_;
    std::string prefix_;
    std::string map_frame_;
    std::optional<Outlet> frames_;
    std::optional<Outlet> points_;
    std::optional<Outlet> diagnostics_;
    std::map<SensorId, Outlet> ranges_;
    RobotFacts robot_;
    std::vector<watch::WatchedRange> round_;
    HostTime round_begun_;
    WallTime round_time_;
    std::optional<nlohmann::ordered_json> status_;
    std::string lost_ = "not connected yet";
    std::vector<ros::diagnostic_msgs::DiagnosticStatus> notes_;
    std::vector<ros::geometry_msgs::TransformStamped> other_frames_;
    std::optional<HostTime> diagnosed_;
};

}  // namespace octoskin::bridge
