// The daemon's status, for users and for scripts: one JSON object (docs/status.md has every key).
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/camera_feed.hpp"
#include "host/apps/daemon/inputs.hpp"
#include "host/apps/daemon/log_queue.hpp"
#include "host/apps/daemon/map_saver.hpp"
#include "host/apps/daemon/problem_log.hpp"
#include "host/apps/daemon/recorder.hpp"
#include "host/apps/daemon/watch_server.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// When frames of a camera were last used or left out; empty: never.
struct CameraUse {
    std::optional<HostTime> frame;
    std::optional<HostTime> left_out;        ///< for lack of time (queue_overflow)...
    std::optional<HostTime> left_out_since;  ///< ... again and again, at least once a second

    std::uint64_t used_before = 0;
    std::uint64_t left_out_before = 0;
};

/// When inputs of each kind were last used, and when some problems last occurred; empty: never.
class LastUsed {
  public:
    /// Call this often: inputs used since the last call count as used now.
    void note(const Pipeline& pipeline, const HostRig& rig, HostTime now);

    std::optional<HostTime> joint_sample;
    std::optional<HostTime> joint_jump;     ///< a sample was rejected because of a jump
    std::optional<HostTime> joint_senders;  ///< two contradicted each other, or a sample was withheld for it
    std::optional<HostTime> reading;
    std::vector<CameraUse> cameras{1};   ///< in the rig's order, at least one
    std::optional<HostTime> time_back;   ///< the bus time went back
    std::optional<HostTime> time_ahead;  ///< the bus time jumped ahead

  private:
    std::array<std::uint64_t, 6> counts_{};
};

struct ReloadCounts {
    std::uint64_t count = 0;
    std::uint64_t unchanged = 0;  ///< how often the files were unchanged
    std::uint64_t dropped = 0;    ///< waiting readings, joint samples and depth frames that could not be used
    std::optional<HostTime> reading_since = {};  ///< start of the reload in progress; empty: none is
};

/// All inputs of the status. The objects that it points to must exist.
struct DaemonView {
    HostTime now;
    /// The same instant on the bus clock (BusTime), which SYNC distributes, maybe from another host. Empty
    /// while it is not known.
    std::optional<HostTime> bus_now;
    /// The same; while it is not known, reckoned from when it last was.
    HostTime bus_reckoned;
    HostTime started;
    const HostRig* rig = nullptr;
    const Pipeline* pipeline = nullptr;
    const Inputs* inputs = nullptr;
    bool is_wall_clock_right = true;  ///< this machine's clock is in the range of time stamps (tells_time)
    const std::string* interface = nullptr;
    bool is_listen_only = false;
    std::vector<CameraRecord> cameras;  ///< in the rig's order; empty without one, or if none is read
    LastUsed used;
    LogRecord log;
    SaveRecord saves;
    std::optional<HostTime> maps_silent_since;  ///< since when a save or check of the folder hangs
    std::string maps_problem;                   ///< the problem of the maps' folder; empty: none
    const Recorder* recorder = nullptr;  ///< the running recorder, or the last one; null if there was none
    std::string recording_refusal;       ///< why the newest one could not start; empty if it could
    std::string reload_error;            ///< of the newest SIGHUP; empty if it succeeded
    ReloadCounts reloads;
    std::optional<HostTime> reloaded;  ///< when SIGHUP last changed something
    WatchServer::Record watch = {};

    /// The time, the nodes and their reports are being collected again: whether one is missing cannot be
    /// decided yet. The period covers two exchanges of SYNC a second apart, the readings after them, and the
    /// opening of a camera.
    [[nodiscard]] bool is_settling() const noexcept {
        constexpr Nanoseconds kSettle{3'000'000'000};
        return reloaded && now - *reloaded < kSettle;
    }
};

/// All problems, the most fundamental first, a sentence each. If the map is empty, the reason is among them.
[[nodiscard]] std::vector<Problem> problems(const DaemonView& view);
/// The problem of a camera that has `rate_hz` frames a second in the rig; empty if there is none. If the rate
/// of its mode differs, the mode's rate is used.
[[nodiscard]] std::optional<Problem> camera_problem(const CameraRecord& camera, double rate_hz, HostTime now);
/// Empty if its mode is not known, or has about the rig's rate.
[[nodiscard]] std::optional<Problem> camera_rate_problem(const CameraRecord& camera, double rate_hz);

/// The newest joint sample, of all sources, that the arm cannot have reached; empty: there was none.
struct JumpOfJoint {
    std::string name;  ///< the joint
    const JointJumped* jumped = nullptr;
};
[[nodiscard]] std::optional<JumpOfJoint> newest_jump(const DaemonView& view);
/// Two senders of joint states are active, and neither is used.
[[nodiscard]] bool are_joints_withheld(const DaemonView& view);
/// Samples come through the joint socket at more than the rig's rate: the surplus is left out.
[[nodiscard]] bool are_joints_above_rate(const DaemonView& view);

[[nodiscard]] nlohmann::ordered_json status_json(const DaemonView& view);

}  // namespace octoskin
