// A problem of the running daemon as data, and the sentence made of it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace octoskin {

/// What kind of problem it is. A script and a test compare it; the sentence may change.
enum class ProblemCode : std::uint8_t {
    wall_clock_wrong,
    can_link,
    kernel_dropped,
    another_host,
    time_back,
    time_ahead,
    time_unknown,
    time_in_doubt,
    links_without_body,
    node_unusable,
    node_restarts,
    node_two_answers,
    node_two_reports,
    node_loses_readings,
    node_unheard,
    node_readings_lost,
    sensor_unheard,
    sensor_readings_lost,
    sensor_two_senders,
    sensor_not_ranging,
    sensor_rejected,
    sensor_contradicts_camera,
    joint_jump,
    joint_senders,
    joint_limits,
    joint_gap,
    joints_missing,
    joints_unused,
    joints_stopped,
    joints_flood,
    joints_too_frequent,
    readings_unused,
    readings_stopped,
    camera_pose,
    joint_pose,
    camera_or_joint_pose,
    camera_no_frames,
    camera_closed,
    camera_untimed,
    camera_repeats,
    camera_silent,
    camera_rate,
    camera_bus_silent,
    camera_size,
    camera_overload,
    depth_unused,
    depth_stopped,
    map_full,
    map_no_memory,
    maps_folder_silent,
    maps_folder,
    map_not_saved,
    recording_failed,
    recording_incomplete,
    recording_silent,
    recording_refused,
    reload_silent,
    reload_refused,
    log_stuck,
};

struct ProblemMeaning {
    ProblemCode code;
    std::string_view name;
    std::string_view meaning;
};

/// In the order of the enumeration.
inline constexpr std::array kProblemMeanings = {
    ProblemMeaning{ProblemCode::wall_clock_wrong, "wall_clock_wrong",
                   "this machine's clock shows a time before 1970 or after 2199"},
    ProblemMeaning{ProblemCode::can_link, "can_link", "the CAN interface is absent, down or disturbed"},
    ProblemMeaning{ProblemCode::kernel_dropped, "kernel_dropped", "the kernel dropped received frames"},
    ProblemMeaning{ProblemCode::another_host, "another_host",
                   "another host sends SYNC or FOLLOW_UP on the bus"},
    ProblemMeaning{ProblemCode::time_back, "time_back", "the bus time went back within the last minute"},
    ProblemMeaning{ProblemCode::time_ahead, "time_ahead", "the bus time jumped ahead within the last minute"},
    ProblemMeaning{ProblemCode::time_unknown, "time_unknown", "the bus time is not known"},
    ProblemMeaning{ProblemCode::time_in_doubt, "time_in_doubt", "the bus time contradicts itself"},
    ProblemMeaning{ProblemCode::links_without_body, "links_without_body",
                   "moving links have no body, so queries answer unknown instead of free"},
    ProblemMeaning{ProblemCode::node_unusable, "node_unusable",
                   "a node is absent, lost or misconfigured, or its time is in doubt"},
    ProblemMeaning{ProblemCode::node_restarts, "node_restarts", "a node restarted within the last 3 s"},
    ProblemMeaning{ProblemCode::node_two_answers, "node_two_answers",
                   "two answers to one SYNC arrive under one node's id"},
    ProblemMeaning{ProblemCode::node_two_reports, "node_two_reports",
                   "contrary reports arrive under one node's id"},
    ProblemMeaning{ProblemCode::node_loses_readings, "node_loses_readings",
                   "over 5 % of a node's readings of the last second were refused"},
    ProblemMeaning{ProblemCode::node_unheard, "node_unheard",
                   "a node's heartbeats arrive, but nothing of its sensors"},
    ProblemMeaning{ProblemCode::node_readings_lost, "node_readings_lost",
                   "all or most of a node's readings are lost on the way"},
    ProblemMeaning{ProblemCode::sensor_unheard, "sensor_unheard",
                   "neither readings nor health of one sensor arrive"},
    ProblemMeaning{ProblemCode::sensor_readings_lost, "sensor_readings_lost",
                   "all or most of one sensor's readings are lost on the way"},
    ProblemMeaning{ProblemCode::sensor_two_senders, "sensor_two_senders",
                   "readings of a second sender arrive under a sensor's name"},
    ProblemMeaning{ProblemCode::sensor_not_ranging, "sensor_not_ranging", "a sensor does not range"},
    ProblemMeaning{ProblemCode::sensor_rejected, "sensor_rejected",
                   "nearly all of a sensor's last readings were rejected"},
    ProblemMeaning{ProblemCode::sensor_contradicts_camera, "sensor_contradicts_camera",
                   "a sensor's ranges contradict the camera"},
    ProblemMeaning{ProblemCode::joint_jump, "joint_jump",
                   "a joint moved faster than the robot description allows"},
    ProblemMeaning{ProblemCode::joint_senders, "joint_senders",
                   "more than one sender of joint states is active, and none is used"},
    ProblemMeaning{ProblemCode::joint_limits, "joint_limits", "a joint is outside its limits"},
    ProblemMeaning{ProblemCode::joint_gap, "joint_gap", "joint states are too far apart for a pose"},
    ProblemMeaning{ProblemCode::joints_missing, "joints_missing", "no joint state has arrived"},
    ProblemMeaning{ProblemCode::joints_unused, "joints_unused", "no joint state could be used"},
    ProblemMeaning{ProblemCode::joints_stopped, "joints_stopped", "joint states have stopped"},
    ProblemMeaning{ProblemCode::joints_flood, "joints_flood",
                   "joint states arrive faster than they can be processed"},
    ProblemMeaning{ProblemCode::joints_too_frequent, "joints_too_frequent",
                   "joint states arrive faster than the rig's rate"},
    ProblemMeaning{ProblemCode::readings_unused, "readings_unused", "no reading could be used"},
    ProblemMeaning{ProblemCode::readings_stopped, "readings_stopped", "readings no longer reach the map"},
    ProblemMeaning{ProblemCode::camera_pose, "camera_pose", "the camera's pose or scale is wrong"},
    ProblemMeaning{ProblemCode::joint_pose, "joint_pose", "a joint's zero is wrong"},
    ProblemMeaning{ProblemCode::camera_or_joint_pose, "camera_or_joint_pose",
                   "the camera's pose or a joint's zero is wrong"},
    ProblemMeaning{ProblemCode::camera_no_frames, "camera_no_frames",
                   "no usable frame of the camera has arrived since the start"},
    ProblemMeaning{ProblemCode::camera_closed, "camera_closed", "the camera is not open"},
    ProblemMeaning{ProblemCode::camera_untimed, "camera_untimed",
                   "frames of the camera have no capture time"},
    ProblemMeaning{ProblemCode::camera_repeats, "camera_repeats",
                   "the camera sends the same image again and again"},
    ProblemMeaning{ProblemCode::camera_silent, "camera_silent", "the camera sends no frames any more"},
    ProblemMeaning{ProblemCode::camera_rate, "camera_rate", "the camera's rate differs from the rig's"},
    ProblemMeaning{ProblemCode::camera_bus_silent, "camera_bus_silent",
                   "images are not used because no joint states arrive"},
    ProblemMeaning{ProblemCode::camera_size, "camera_size", "no image has the rig's size"},
    ProblemMeaning{ProblemCode::camera_overload, "camera_overload",
                   "images arrive faster than this machine processes them"},
    ProblemMeaning{ProblemCode::depth_unused, "depth_unused", "no depth frame could be used"},
    ProblemMeaning{ProblemCode::depth_stopped, "depth_stopped", "depth frames no longer reach the map"},
    ProblemMeaning{ProblemCode::map_full, "map_full", "the map has reached its memory limit"},
    ProblemMeaning{ProblemCode::map_no_memory, "map_no_memory", "the system had no memory for the map"},
    ProblemMeaning{ProblemCode::maps_folder_silent, "maps_folder_silent", "the maps' folder does not answer"},
    ProblemMeaning{ProblemCode::maps_folder, "maps_folder",
                   "the maps' folder cannot be used, or was replaced"},
    ProblemMeaning{ProblemCode::map_not_saved, "map_not_saved", "the newest save of the map failed"},
    ProblemMeaning{ProblemCode::recording_failed, "recording_failed", "the recording failed"},
    ProblemMeaning{ProblemCode::recording_incomplete, "recording_incomplete",
                   "the recording lacks data, and its replay gives another map"},
    ProblemMeaning{ProblemCode::recording_silent, "recording_silent",
                   "the recording's folder does not answer"},
    ProblemMeaning{ProblemCode::recording_refused, "recording_refused", "the newest recording did not start"},
    ProblemMeaning{ProblemCode::reload_silent, "reload_silent",
                   "a reload waits for a file system that does not answer"},
    ProblemMeaning{ProblemCode::reload_refused, "reload_refused", "the newest reload was refused"},
    ProblemMeaning{ProblemCode::log_stuck, "log_stuck", "the log's reader takes no lines"},
};
static_assert(kProblemMeanings.size() == static_cast<std::size_t>(ProblemCode::log_stuck) + 1);

/// "time_back".
[[nodiscard]] constexpr std::string_view name_of(ProblemCode code) noexcept {
    return kProblemMeanings[static_cast<std::size_t>(code)].name;
}

struct Problem {
    ProblemCode code{};
    /// What has the problem: "node 9 'board'", "camera", "can0"; empty: the daemon itself.
    std::string on = {};
    std::string what = {};  ///< the condition, with its figures
    std::string remedy = {};
    /// A counter of the status, or a key of the rig or mapping file; the sentence contains it.
    std::string key = {};
    /// A state or a reason, where problems of one `code` and `on` have different remedies. `code`, `on` and
    /// `detail` identify a problem, even if the figures in its sentence change.
    std::string detail = {};
    /// The part or topic that it is about, if another problem of the same subject may replace it; else empty.
    std::string subject = {};
    /// A subject, or empty. While that subject has a problem, it is unknown whether this problem is over.
    std::string hidden_by = {};

    /// "ON: WHAT: REMEDY", without the parts that are empty.
    [[nodiscard]] std::string text() const;
    [[nodiscard]] bool is_same(const Problem& other) const {
        return code == other.code && on == other.on && detail == other.detail;
    }
    friend bool operator==(const Problem&, const Problem&) = default;
};

}  // namespace octoskin
