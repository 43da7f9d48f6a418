// What each kind of view has: an event loop, the channels, and the web server.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/bridge/view/foxglove_server.hpp"
#include "host/bridge/view/view_server.hpp"
#include "host/bridge/view/web_server.hpp"

namespace octoskin::view {

class ViewHost {
  public:
    /// Listens. `mode`: "live" or "recording"; `meshes`: where those of the robot are.
    [[nodiscard]] static Result<std::unique_ptr<ViewHost>, AppError> open(WebOptions options,
                                                                          MeshSearch meshes,
                                                                          const std::string& mode);
    ~ViewHost() { server_.disconnect(); }
    ViewHost(const ViewHost&) = delete;
    ViewHost& operator=(const ViewHost&) = delete;

    [[nodiscard]] EventLoop& loop() noexcept { return loop_; }
    [[nodiscard]] FoxgloveServer& server() noexcept { return server_; }
    [[nodiscard]] ViewServer& view() noexcept { return *view_; }
    /// Where a browser finds the page: "http://127.0.0.1:8765/".
    [[nodiscard]] std::string url() const;
    /// Until SIGTERM or SIGINT. Throws std::bad_alloc.
    void run();

  private:
    ViewHost(std::string host, const std::string& mode);

    std::string host_;
    EventLoop loop_;
    FoxgloveServer server_;
    std::unique_ptr<ViewServer> view_;
    std::unique_ptr<WebServer> web_;
    std::vector<EventSource> sources_;
};

}  // namespace octoskin::view
