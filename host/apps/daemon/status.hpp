// What is going on, for a person and for a script: one JSON object (docs/daemon.md has every key).
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
#include "host/apps/daemon/map_keeper.hpp"
#include "host/apps/daemon/problem_log.hpp"
#include "host/apps/daemon/recorder.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// When something last happened; empty if never.
class LastUsed {
  public:
    /// To be asked often: what was used since the last time was used now.
    void note(const Pipeline& pipeline, HostTime now);

    std::optional<HostTime> joint_sample;
    std::optional<HostTime> joint_jump;     ///< one was rejected for it
    std::optional<HostTime> joint_senders;  ///< two contradicted each other, or one was withheld for it
    std::optional<HostTime> reading;
    std::optional<HostTime> depth_frame;
    std::optional<HostTime> time_back;             ///< the bus's time went back
    std::optional<HostTime> time_ahead;            ///< or ahead of what passed
    std::optional<HostTime> depth_left_out;        ///< for lack of time (queue_overflow)...
    std::optional<HostTime> depth_left_out_since;  ///< ... again and again, at least once a second

  private:
    std::array<std::uint64_t, 8> counts_{};
};

struct ReloadCounts {
    std::uint64_t count = 0;
    std::uint64_t unchanged = 0;  ///< times that the files said what held already
    std::uint64_t dropped = 0;    ///< readings, joint samples, depth frames that waited and could not be used
    std::optional<HostTime> reading_since = {};  ///< the files are being read; empty: they are not
};

/// All that there is to tell. What it points to must be there.
struct DaemonView {
    HostTime now;
    /// The same instant on the bus (BusTime), on the clock that SYNC tells: another host's, if that one sends
    /// it. Empty while nobody can tell.
    std::optional<HostTime> bus_now;
    HostTime started;
    const HostRig* rig = nullptr;
    const Pipeline* pipeline = nullptr;
    const Inputs* inputs = nullptr;
    bool is_wall_clock_right = true;  ///< this machine's shows a time that a stamp can have (tells_time)
    const std::string* interface = nullptr;
    bool is_listen_only = false;
    std::optional<CameraRecord> camera;  ///< empty without a camera
    LastUsed used;
    LogRecord log;
    SaveRecord saves;
    std::optional<HostTime> maps_silent_since;  ///< a save or a look at the folder hangs; empty: none does
    std::string maps_problem;                   ///< what has become of the maps' folder; empty: it is there
    const Recorder* recorder = nullptr;         ///< at work, or the last one; null if there was none
    std::string recording_refusal;              ///< why the newest one could not begin; empty if it could
    std::string reload_error;                   ///< of the newest SIGHUP; empty if it went well
    ReloadCounts reloads;
    std::optional<HostTime> reloaded;  ///< when SIGHUP changed something last

    /// The time, the nodes and what they tell are learnt anew: whether they are missing nobody can say yet.
    /// Two exchanges of SYNC a second apart, the readings after them, and a camera that is opened again.
    [[nodiscard]] bool is_settling() const noexcept {
        constexpr Nanoseconds kSettle{3'000'000'000};
        return reloaded && now - *reloaded < kSettle;
    }
};

/// What is wrong, the most fundamental first, a sentence each: "nothing in my map" has its answer here.
[[nodiscard]] std::vector<Problem> problems(const DaemonView& view);
/// What is wrong with a camera of which the rig has `rate_hz` frames a second; empty if it is well. A camera
/// whose mode has another rate is measured by its own.
[[nodiscard]] std::optional<Problem> camera_problem(const CameraRecord& camera, double rate_hz, HostTime now);
/// Empty if it is in no mode that is known, or in one of about the rig's rate.
[[nodiscard]] std::optional<Problem> camera_rate_problem(const CameraRecord& camera, double rate_hz);

/// Two senders of joint states are heard, and neither is used.
[[nodiscard]] bool are_joints_withheld(const DaemonView& view);
/// More comes through the joint socket than the rig's rate: what is left out is of no use.
[[nodiscard]] bool are_joints_above_rate(const DaemonView& view);

[[nodiscard]] nlohmann::ordered_json status_json(const DaemonView& view);

}  // namespace octoskin
