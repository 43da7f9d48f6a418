// `octoskin run`: what is there for as long as the robot is. One thread owns the pipeline and the map; the
// camera and the disk have threads of their own, which hand over values.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/mapping/mapping_config.hpp"

namespace octoskin {

struct DaemonRequest {
    std::filesystem::path rig;
    std::filesystem::path robot;           ///< empty: the rig's
    std::string configuration = "robust";  ///< how measurements become voxels: a built-in one, or a file
    std::string interface = "can0";
    /// In place of the interface: a descriptor that carries frames as a raw CAN socket does.
    std::optional<int> can_descriptor;
    bool is_listen_only = false;         ///< transmits nothing, SYNC included
    bool has_camera = true;              ///< if the rig has one
    std::string camera_uri;              ///< of OpenNI2, or an .oni file; empty: the first there is
    std::filesystem::path joint_socket;  ///< empty: joint states come over CAN only
    std::filesystem::path control_socket;
    std::filesystem::path map_folder;
    std::chrono::seconds save_period{20};
};

class Daemon {
  public:
    /// Reads rig and robot, takes the sockets, loads the map that was saved last. A CAN interface or camera
    /// that is not there yet is no error.
    [[nodiscard]] static Result<std::unique_ptr<Daemon>, AppError> build(const DaemonRequest& request);
    ~Daemon();

    /// Until SIGTERM or SIGINT; then the map is saved, within 5 s. SIGHUP reads rig, robot and mapping
    /// again: all of them, or none.
    [[nodiscard]] ExitCode run();

  private:
    struct Parts;
    explicit Daemon(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

}  // namespace octoskin
