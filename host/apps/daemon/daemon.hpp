// `octoskin run`: what is there for as long as the robot is. One thread owns the pipeline and the map; the
// camera, the disk, the socket for joint states and what is worked out of an image have threads of their own,
// which hand over values.
#pragma once

#include <memory>

#include "common/result.hpp"
#include "host/apps/daemon/log_queue.hpp"
#include "host/apps/daemon/settings.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

class Daemon {
  public:
    /// Reads rig and robot, takes the sockets, loads the map that was saved last. A CAN interface or camera
    /// that is not there yet is no error. `log`: what its status tells of it.
    [[nodiscard]] static Result<std::unique_ptr<Daemon>, AppError> build(const DaemonRequest& request,
                                                                         std::shared_ptr<const LogQueue> log);
    ~Daemon();

    /// Until SIGTERM or SIGINT; then the map is saved, and it returns within 5 s, saved or not; with a map of
    /// over 64 MiB 134 ms later for each MiB beyond, at most. SIGHUP reads rig, robot and mapping again: all
    /// of them, or none.
    [[nodiscard]] ExitCode run();

  private:
    struct Parts;
    explicit Daemon(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

}  // namespace octoskin
