// A recording as the events of a daemon: played through the host's pipeline, at any pace.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/bridge/bridge/daemon_link.hpp"
#include "host/bridge/recorded/bus_clock.hpp"
#include "host/bridge/robot/robot_facts.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin::bridge {

/// What a daemon does not send. The calls come from the thread of RecordedEvents::play.
class RecordedDetails {
  public:
    virtual ~RecordedDetails() = default;
    /// The recording has reached this time; called before each event, and never with an earlier time than
    /// before.
    virtual void on_time(HostTime /*bus*/, WallTime /*wall*/) {}
    /// An image that went into the map.
    virtual void on_depth(const DepthFrame& /*frame*/) {}
};

class RecordedEvents {
  public:
    /// A map is given at most ten times in a second of the recording.
    static constexpr Nanoseconds kMapPeriod{100'000'000};

    /// Reads rig and robot, and the beginning of the log. `request.recording`: a folder with a can.log;
    /// `maps` and `listener` of the request are not used. Errors: `unsupported` (a data set or a lone .oni),
    /// and those of check_playable() and of rig and robot.
    [[nodiscard]] static Result<RecordedEvents, AppError> open(PlaybackRequest request);

    [[nodiscard]] const RobotFacts& robot() const noexcept { return robot_; }
    [[nodiscard]] const std::shared_ptr<const HostSetup>& setup() const noexcept { return setup_; }
    /// The text of the URDF, as given or recorded.
    [[nodiscard]] const std::string& robot_description() const noexcept { return urdf_; }
    [[nodiscard]] const BusClock& clock() const noexcept { return clock_; }
    /// False: nothing in the log gives the wall time, and wall times are bus times.
    [[nodiscard]] bool has_wall_time() const noexcept { return has_wall_time_; }

    /// Plays all of it at the pace of the request (Pace::times(1.0): real time) and calls `listener`: the
    /// robot once, then the status, maps, ranges and joint samples in the order in which they enter the map,
    /// and at the end the last map and a status with the warnings about the recording. `on_lost` is not
    /// called. An exception of the listener ends it and is passed on. Errors: those of play_recording().
    /// Cost: a replay of the fused map, and the bricks that changed for each map.
    [[nodiscard]] Result<Playback, AppError> play(DaemonListener& listener,
                                                  RecordedDetails* details = nullptr,
                                                  const ReplayReport& report = {});

  private:
    RecordedEvents(PlaybackRequest request, std::shared_ptr<const HostSetup> setup,
                   nlohmann::ordered_json described, RobotFacts robot, std::string urdf,
                   std::optional<BusClock> clock);

    PlaybackRequest request_;
    std::shared_ptr<const HostSetup> setup_;
    nlohmann::ordered_json described_;  ///< as a daemon answers `describe`
    RobotFacts robot_;
    std::string urdf_;
    std::vector<std::size_t> joint_counts_;  ///< of each source
    BusClock clock_;
    bool has_wall_time_;
};

}  // namespace octoskin::bridge
