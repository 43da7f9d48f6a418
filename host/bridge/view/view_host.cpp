#include "host/bridge/view/view_host.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/version/version.hpp"

namespace octoskin::view {
namespace {

using namespace std::chrono_literals;

foxglove::ServerInfo server_info(const std::string& mode) {
    return {.name = "octoskin",
            .capabilities = {"services"},
            .encodings = {"json"},
            .metadata = {{"version", program_version()}, {"mode", mode}},
            .session = fmt::format("{}-{}", ::getpid(), wall_now().ns)};
}

}  // namespace

ViewHost::ViewHost(std::string host, const std::string& mode)
    : host_(std::move(host)), server_(server_info(mode)), view_(ViewServer::open(server_, mode).value()) {}

Result<std::unique_ptr<ViewHost>, AppError> ViewHost::open(WebOptions options, MeshSearch meshes,
                                                           const std::string& mode) {
    std::unique_ptr<ViewHost> made(new ViewHost(options.host, mode));
    made->view_->serve_meshes(std::move(meshes));
    auto web = WebServer::open(std::move(options), made->server_);
    if (!web) return unexpected(web.error());
    made->web_ = std::move(web).value();
    made->server_.connect(
        {.wake = [raw = made->web_.get()](ClientId client) { raw->wake(client); },
         .drop = [raw = made->web_.get()](ClientId client, Refusal why) { raw->drop(client, why); }});
    return made;
}

std::string ViewHost::url() const {
    const bool is_v6 = host_.find(':') != std::string::npos && !host_.starts_with('[');
    return fmt::format("http://{}:{}/", is_v6 ? '[' + host_ + ']' : host_, web_->port());
}

void ViewHost::run() {
    for (const int signal : {SIGTERM, SIGINT})
        sources_.push_back(loop_.on_signal(signal, [this] { loop_.stop(0); }));
    sources_.push_back(loop_.every(17ms, [this] { view_->attend(); }));
    sources_.push_back(loop_.every(3s, [this] { view_->notify_counts(); }));
    web_->run(loop_);
    sources_.clear();
}

}  // namespace octoskin::view
