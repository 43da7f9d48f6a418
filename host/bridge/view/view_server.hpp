// What the daemon says as channels of the view, and the view's services.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/bridge/bridge/daemon_link.hpp"
#include "host/bridge/outlets/map_outlets.hpp"
#include "host/bridge/outlets/sensor_outlets.hpp"
#include "host/bridge/robot/robot_now.hpp"
#include "host/bridge/view/foxglove_server.hpp"
#include "host/bridge/view/map_board.hpp"
#include "host/bridge/view/robot_meshes.hpp"
#include "host/bridge/view/view_topics.hpp"

namespace octoskin::view {

/// Listens to a daemon, or to a recording that is played.
class ViewServer final : public bridge::DaemonListener {
  public:
    /// `server` must outlive it. `mode`: "live" or "recording".
    [[nodiscard]] static Result<std::unique_ptr<ViewServer>, Error> open(FoxgloveServer& server,
                                                                         std::string mode);

    ~ViewServer() override { server_.close(map_); }  // its readers use the board
    ViewServer(const ViewServer&) = delete;
    ViewServer& operator=(const ViewServer&) = delete;

    void on_described(const nlohmann::ordered_json& described) override;
    void on_robot(bridge::RobotFacts robot) override;
    void on_map(const watch::WatchedMap& map) override;
    void on_range(const watch::WatchedRange& range, HostTime captured) override;
    void on_joints(const watch::WatchedJoints& joints, HostTime sampled) override;
    void on_status(const nlohmann::ordered_json& status) override;
    void on_lost(const std::string& why) override;
    void on_urdf(const std::string& text) override;
    void on_image(const watch::WatchedImage& image, HostTime captured) override;
    /// Clients get the meshes that the robot's URDF names. To be called before a client is there.
    void serve_meshes(MeshSearch search);
    /// What a recording says of its place in time.
    void change_place(nlohmann::ordered_json place);

    /// Sends what is due. Call it every 17 ms.
    void attend();
    /// Shows clients what is refused and dropped. Call it every few seconds.
    void notify_counts();

  private:
    /// Positions of one source that were not published yet.
    struct Joints {
        std::vector<double> position;
        HostTime sampled;
    };
    ViewServer(FoxgloveServer& server, std::string mode, std::unique_ptr<ViewTopics> topics,
               bridge::MapOutlets map, bridge::SensorOutlets sensors, bridge::Outlet frames,
               bridge::Outlet urdf);
    [[nodiscard]] ChannelId open_json(const std::string& topic, const std::string& type);
    void open_images();
    void publish_link();
    void publish_robot();
    void publish_joints();
    void publish_ranges();
    void publish_frames(WallTime wall);

    FoxgloveServer& server_;
    std::string mode_;
    std::unique_ptr<ViewTopics> topics_;
    bridge::MapOutlets map_outlets_;
    bridge::SensorOutlets sensors_;
    bridge::Outlet frames_;
    bridge::Outlet urdf_outlet_;
    MapBoard board_;
    ChannelId map_;
    ChannelId ranges_;
    ChannelId joints_;
    ChannelId status_;
    ChannelId robot_channel_;
    ChannelId link_;
    std::map<std::string, ChannelId> images_;  ///< by topic

    std::optional<bridge::RobotFacts> robot_;
    std::optional<bridge::RobotNow> robot_now_;
    nlohmann::ordered_json described_;
    std::optional<std::string> urdf_;
    std::optional<RobotMeshes> meshes_;
    bool is_connected_ = false;
    std::string why_ = "not connected yet";
    nlohmann::ordered_json place_;
    std::map<std::size_t, Joints> joints_waiting_;  ///< by source
    std::string ranges_waiting_;
    bool are_frames_due_ = false;
    std::optional<HostTime> joints_sent_;
    std::optional<HostTime> ranges_sent_;
};

}  // namespace octoskin::view
