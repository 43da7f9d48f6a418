// `octoskin run`: the daemon beside the robot. One thread owns the pipeline and the map. The camera, the
// disk, the socket for joint states and the processing of depth images have their own threads, which pass
// values.
#pragma once

#include <memory>

#include "common/result.hpp"
#include "host/apps/daemon/log_queue.hpp"
#include "host/apps/daemon/settings.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

class Daemon {
  public:
    /// Reads rig and robot, opens the sockets, and loads the map saved last. A CAN interface or camera that
    /// is missing yet is no error. `log`: its status goes into the daemon's status.
    [[nodiscard]] static Result<std::unique_ptr<Daemon>, AppError> build(const DaemonRequest& request,
                                                                         std::shared_ptr<const LogQueue> log);
    ~Daemon();

    /// Runs until SIGTERM or SIGINT; then saves the map and returns within 5 s, saved or not. With a map of
    /// over 64 MiB it takes at most 134 ms longer for each MiB beyond. SIGHUP reads rig, robot and mapping
    /// again: all of them, or none.
    [[nodiscard]] ExitCode run();

  private:
    struct Parts;
    explicit Daemon(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

}  // namespace octoskin
