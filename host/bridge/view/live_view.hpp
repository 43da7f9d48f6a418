// The view of a running daemon.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/bridge/bridge/daemon_link.hpp"
#include "host/bridge/view/daemon_requests.hpp"
#include "host/bridge/view/view_host.hpp"

namespace octoskin::view {

class LiveView {
  public:
    /// Listens. A daemon need not be there. `control`: its socket; `meshes`: where those of the robot are.
    [[nodiscard]] static Result<std::unique_ptr<LiveView>, AppError> open(std::filesystem::path control,
                                                                          WebOptions options,
                                                                          MeshSearch meshes);
    LiveView(const LiveView&) = delete;
    LiveView& operator=(const LiveView&) = delete;

    [[nodiscard]] std::string url() const { return host_->url(); }
    /// Until SIGTERM or SIGINT. Throws std::bad_alloc.
    void run();

  private:
    LiveView(std::unique_ptr<ViewHost> host, const std::filesystem::path& control);
    void add_services();
    /// Connects to a daemon that answers. One that hangs is asked again and again, without waiting for it.
    void attend_daemon();

    std::unique_ptr<ViewHost> host_;
    DaemonRequests requests_;
    bridge::DaemonLink daemon_;
    bool is_asking_ = false;  ///< whether a daemon answers
    std::vector<EventSource> sources_;
};

}  // namespace octoskin::view
