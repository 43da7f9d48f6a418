#include "host/bridge/view/live_view.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/version/version.hpp"

namespace octoskin::view {
namespace {

using namespace std::chrono_literals;

/// A question may take ten seconds of the daemon's processor time.
constexpr Nanoseconds kQueryPatience = 15s;
constexpr Nanoseconds kVoxelPatience = 3s;
constexpr Nanoseconds kHelloPatience = 2s;

foxglove::ServerInfo server_info(const std::string& mode) {
    return {.name = "octoskin",
            .capabilities = {"services"},
            .encodings = {"json"},
            .metadata = {{"version", program_version()}, {"mode", mode}},
            .session = fmt::format("{}-{}", ::getpid(), wall_now().ns)};
}

}  // namespace

LiveView::LiveView(LiveViewOptions options)
    : options_(std::move(options)),
      server_(server_info("live")),
      view_(ViewServer::open(server_, "live").value()),
      requests_(loop_, options_.control),
      daemon_(loop_, options_.control, *view_, {.request = bridge::DaemonLink::kAllFrames}) {}

Result<std::unique_ptr<LiveView>, AppError> LiveView::open(LiveViewOptions options) {
    std::unique_ptr<LiveView> made(new LiveView(std::move(options)));
    auto web = WebServer::open(made->options_.web, made->server_);
    if (!web) return unexpected(web.error());
    made->web_ = std::move(web).value();
    made->server_.connect(
        {.wake = [raw = made->web_.get()](ClientId client) { raw->wake(client); },
         .drop = [raw = made->web_.get()](ClientId client, Refusal why) { raw->drop(client, why); }});
    made->add_services();
    return made;
}

std::string LiveView::url() const {
    const std::string& host = options_.web.host;
    const bool is_v6 = host.find(':') != std::string::npos && !host.starts_with('[');
    return fmt::format("http://{}:{}/", is_v6 ? '[' + host + ']' : host, web_->port());
}

void LiveView::add_services() {
    const auto add = [this](const std::string& word, const std::string& type, Nanoseconds patience) {
        server_.add_service("/octoskin/" + word, type, [this, word, patience](std::string json, Reply reply) {
            requests_.ask(word + ' ' + json, patience, std::move(reply));
        });
    };
    add("query", "octoskin.Query", kQueryPatience);
    add("voxel", "octoskin.Voxel", kVoxelPatience);
}

void LiveView::attend_daemon() {
    if (daemon_.is_connected() || is_asking_) return;
    is_asking_ = true;
    requests_.ask("hello", kHelloPatience, [this](const Result<std::string, std::string>& answer) {
        is_asking_ = false;
        answer ? daemon_.attend() : view_->on_lost(answer.error());
    });
}

void LiveView::run() {
    for (const int signal : {SIGTERM, SIGINT})
        sources_.push_back(loop_.on_signal(signal, [this] { loop_.stop(0); }));
    sources_.push_back(loop_.every(17ms, [this] { view_->attend(); }));
    sources_.push_back(loop_.every(100ms, [this] { requests_.attend(); }));
    sources_.push_back(loop_.every(500ms, [this] { attend_daemon(); }));
    sources_.push_back(loop_.every(3s, [this] { view_->notify_counts(); }));
    attend_daemon();
    web_->run(loop_);
    sources_.clear();
}

}  // namespace octoskin::view
