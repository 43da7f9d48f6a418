// Writes what happens in a recording to the topics of the bridge, in an MCAP file.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/bridge/mcap/mcap_topics.hpp"
#include "host/bridge/outlets/map_outlets.hpp"
#include "host/bridge/outlets/sensor_outlets.hpp"
#include "host/bridge/recorded/recorded_events.hpp"
#include "host/bridge/robot/robot_now.hpp"
#include "host/io/candump/log_reader.hpp"

namespace octoskin::bridge {

struct ExportOptions {
    MapTopics topics = {};
    /// A map on its topics at most once in this time.
    Nanoseconds map_period{500'000'000};
};

/// Topics that are not in the file unless they are asked for: large, or of use to few.
[[nodiscard]] std::vector<std::string> optional_topics(const MapTopics& topics);

class RecordingExport final : public DaemonListener, public RecordedDetails {
  public:
    /// Opens all topics. `sink`, `recorded` and its recording must outlive this object. Errors: those of the
    /// sink, and of a can.log that cannot be read.
    [[nodiscard]] static Result<std::unique_ptr<RecordingExport>, Error> open(McapTopics& sink,
                                                                              const RecordedEvents& recorded,
                                                                              const RecordingPaths& paths,
                                                                              ExportOptions options);

    /// After the playback: the last map, and the rest of the log.
    void finish();

    void on_robot(RobotFacts robot) override;
    void on_map(const watch::WatchedMap& map) override;
    void on_range(const watch::WatchedRange& range, HostTime captured) override;
    void on_joints(const watch::WatchedJoints& joints, HostTime sampled) override;
    void on_status(const nlohmann::ordered_json& status) override;
    void on_lost(const std::string&) override {}
    void on_time(HostTime bus, WallTime wall) override;
    void on_depth(const DepthFrame& frame) override;

    /// The time from the first event to the newest one.
    [[nodiscard]] Nanoseconds duration() const noexcept { return begun_ ? now_ - *begun_ : Nanoseconds{0}; }

  private:
    struct Camera {
        Outlet image;
        Outlet info;
    };
    struct Parts {
        MapOutlets map;
        SensorOutlets sensors;
        Outlet joints;
        Outlet links;
        Outlet description;
        Outlet can;
        Outlet can_fd;
        std::vector<Camera> cameras;
        candump::LogReader log;
    };
    RecordingExport(McapTopics& sink, const RecordedEvents& recorded, ExportOptions options, Parts parts)
        : sink_(sink), recorded_(recorded), options_(std::move(options)), parts_(std::move(parts)) {}
    [[nodiscard]] static Result<Parts, Error> open_parts(McapTopics& sink, const RecordedEvents& recorded,
                                                         const RecordingPaths& paths,
                                                         const ExportOptions& options);
    void begin(WallTime wall);
    void send_links(HostTime sampled);
    void send_log(std::optional<WallTime> until);
    void send_frame(const candump::LogEntry& entry);

    McapTopics& sink_;
    const RecordedEvents& recorded_;
    ExportOptions options_;
    Parts parts_;
    std::optional<RobotNow> robot_now_;
    std::optional<candump::LogEntry> next_entry_;
    bool is_log_over_ = false;
    std::optional<HostTime> begun_;
    HostTime now_;
    std::optional<HostTime> map_attended_;
    std::optional<HostTime> links_sent_;
};

}  // namespace octoskin::bridge
