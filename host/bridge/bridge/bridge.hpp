// The bridge: what the daemon knows on ROS 2's topics, and ROS 2's joint states, images and planner's objects
// to the daemon and into what is published. One thread, and one for each camera.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/bridge/bridge/daemon_link.hpp"
#include "host/bridge/bridge/image_inlet.hpp"
#include "host/bridge/bridge/inlet.hpp"
#include "host/bridge/dds/dds_topics.hpp"
#include "host/bridge/dds/participant.hpp"
#include "host/bridge/outlets/map_outlets.hpp"
#include "host/bridge/outlets/sensor_outlets.hpp"
#include "host/bridge/received/joint_states.hpp"
#include "host/bridge/received/recent.hpp"
#include "host/bridge/received/scene_objects.hpp"
#include "host/bridge/robot/robot_now.hpp"

namespace octoskin::bridge {

struct BridgeOptions {
    std::filesystem::path control;
    std::filesystem::path joints;         ///< the daemon's joint socket
    std::filesystem::path status_socket;  ///< of the bridge
    bool this_machine_only = false;
    MapTopics topics = {};
    std::string joint_states = "/joint_states";
    std::string planner_scene = "/monitored_planning_scene";
    std::string robot_description = "/robot_description";
    std::string planning_frame = {};  ///< another name of the URDF's root link in the planner's objects
};

class Bridge final : public DaemonListener {
  public:
    /// Takes part in the DDS network and opens its topics. The daemon may come later.
    [[nodiscard]] static Result<std::unique_ptr<Bridge>, AppError> open(BridgeOptions options);
    ~Bridge() override;

    /// Runs until SIGTERM or SIGINT.
    void run();

    void on_robot(RobotFacts robot) override;
    void on_map(const watch::WatchedMap& map) override;
    void on_range(const watch::WatchedRange& range, HostTime captured) override;
    void on_joints(const watch::WatchedJoints& joints, HostTime sampled) override;
    void on_status(const nlohmann::ordered_json& status) override;
    void on_lost(const std::string& why) override;

  private:
    Bridge(BridgeOptions options, dds::Network network, std::unique_ptr<dds::Participant> participant,
           std::unique_ptr<dds::Topics> topics, MapOutlets map, SensorOutlets sensors);
    void on_dds();
    void attend_network();
    void attend_interfaces();
    void publish();
    void take_joint_states();
    void take_planner_scenes();
    void take_robot_description();
    void compare_description();
    void send_joints(const std::string& line);
    void update_surroundings();
    void report_problems();
    [[nodiscard]] std::vector<std::string> problems() const;
    [[nodiscard]] std::vector<std::string> joint_problems() const;
    [[nodiscard]] std::uint32_t matched_topics() const;
    [[nodiscard]] std::string answer(const std::string& request) const;
    [[nodiscard]] nlohmann::ordered_json status() const;
    [[nodiscard]] nlohmann::ordered_json topics() const;
    [[nodiscard]] nlohmann::ordered_json cameras() const;

    BridgeOptions options_;
    dds::Network network_;
    EventLoop loop_;
    std::unique_ptr<dds::Participant> participant_;
    std::unique_ptr<dds::Topics> topics_;
    MapOutlets map_;
    SensorOutlets sensors_;
    std::optional<DaemonLink> daemon_;
    std::unique_ptr<ControlSocket> status_socket_;
    std::optional<RobotFacts> robot_;
    std::optional<RobotNow> robot_now_;
    Inlet joint_topic_;
    JointStates joint_states_;
    Recent<JointStateCounts> joints_lately_;
    int joint_socket_ = -1;
    Inlet scene_topic_;
    SceneObjects objects_;
    std::vector<std::string> unplaced_;  ///< frames of objects that are not known
    Inlet description_topic_;
    std::optional<std::string> description_;  ///< the newest URDF of the topic
    std::string description_problem_;
    std::vector<std::unique_ptr<ImageInlet>> cameras_;
    std::vector<std::string> reported_;  ///< problems in the log
    std::string lost_ = "not connected yet";
    bool has_clock_topic_ = false;
    std::set<std::string> interfaces_;      ///< of the network, since the start
    std::set<std::string> interfaces_now_;  ///< those that have a carrier
    std::size_t others_ = 0;
    HostTime begun_;
    std::vector<EventSource> sources_;
};

}  // namespace octoskin::bridge
