// What is going on, for a person and for a script: one JSON object (docs/daemon.md has every key).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/camera_feed.hpp"
#include "host/apps/daemon/can_link.hpp"
#include "host/apps/daemon/joint_socket.hpp"
#include "host/apps/daemon/latency.hpp"
#include "host/apps/daemon/map_keeper.hpp"
#include "host/apps/daemon/recorder.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// When something was last used for the map; empty if never.
struct LastUsed {
    std::optional<HostTime> joint_sample;
    std::optional<HostTime> reading;
    std::optional<HostTime> depth_frame;
};

/// All that there is to tell. What it points to must be there.
struct DaemonView {
    HostTime now;
    /// The same instant on the clock that SYNC tells: another host's, if that one sends it.
    HostTime bus_now;
    HostTime started;
    const HostRig* rig = nullptr;
    const Pipeline* pipeline = nullptr;
    const CanLink* can = nullptr;
    const std::string* interface = nullptr;
    bool is_listen_only = false;
    std::optional<HostTime> foreign_sync;  ///< another host's newest SYNC, while this one sends its own
    const JointSocket* joints = nullptr;   ///< null without a socket
    std::optional<CameraRecord> camera;    ///< empty without a camera
    const LatencyHistogram* latency = nullptr;
    LastUsed used;
    SaveRecord saves;
    const Recorder* recorder = nullptr;  ///< at work, or the last one; null if there was none
    std::string reload_error;            ///< of the newest SIGHUP; empty if it went well
};

/// What is wrong, the most fundamental first, a sentence each: "nothing in my map" has its answer here.
[[nodiscard]] std::vector<std::string> problems(const DaemonView& view);

[[nodiscard]] nlohmann::ordered_json status_json(const DaemonView& view);

}  // namespace octoskin
