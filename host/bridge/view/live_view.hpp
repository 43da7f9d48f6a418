// The view of a running daemon: its connection, the channels and the web server in one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/bridge/bridge/daemon_link.hpp"
#include "host/bridge/view/daemon_requests.hpp"
#include "host/bridge/view/foxglove_server.hpp"
#include "host/bridge/view/view_server.hpp"
#include "host/bridge/view/web_server.hpp"

namespace octoskin::view {

struct LiveViewOptions {
    std::filesystem::path control;  ///< the daemon's socket
    WebOptions web = {};
};

class LiveView {
  public:
    /// Listens. A daemon need not be there.
    [[nodiscard]] static Result<std::unique_ptr<LiveView>, AppError> open(LiveViewOptions options);
    ~LiveView() { server_.disconnect(); }
    LiveView(const LiveView&) = delete;
    LiveView& operator=(const LiveView&) = delete;

    /// Where a browser finds the page: "http://127.0.0.1:8765/".
    [[nodiscard]] std::string url() const;
    /// Until SIGTERM or SIGINT. Throws std::bad_alloc.
    void run();

  private:
    explicit LiveView(LiveViewOptions options);
    void add_services();
    /// Connects to a daemon that answers. One that hangs is asked again and again, without waiting for it.
    void attend_daemon();

    LiveViewOptions options_;
    EventLoop loop_;
    FoxgloveServer server_;
    std::unique_ptr<ViewServer> view_;
    DaemonRequests requests_;
    bridge::DaemonLink daemon_;
    bool is_asking_ = false;  ///< whether a daemon answers
    std::unique_ptr<WebServer> web_;
    std::vector<EventSource> sources_;
};

}  // namespace octoskin::view
