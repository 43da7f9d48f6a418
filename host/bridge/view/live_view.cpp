#include "host/bridge/view/live_view.hpp"

#include <utility>

namespace octoskin::view {
namespace {

using namespace std::chrono_literals;

/// A question may take ten seconds of the daemon's processor time.
constexpr Nanoseconds kQueryPatience = 15s;
constexpr Nanoseconds kVoxelPatience = 3s;
constexpr Nanoseconds kHelloPatience = 2s;

}  // namespace

LiveView::LiveView(std::unique_ptr<ViewHost> host, const std::filesystem::path& control)
    : host_(std::move(host)),
      requests_(host_->loop(), control),
      daemon_(host_->loop(), control, host_->view(), {.request = bridge::DaemonLink::kAllFrames}) {
    add_services();
}

Result<std::unique_ptr<LiveView>, AppError> LiveView::open(std::filesystem::path control, WebOptions options,
                                                           MeshSearch meshes) {
    auto host = ViewHost::open(std::move(options), std::move(meshes), "live");
    if (!host) return unexpected(host.error());
    return std::unique_ptr<LiveView>(new LiveView(std::move(host).value(), control));
}

void LiveView::add_services() {
    const auto add = [this](const std::string& word, const std::string& type, Nanoseconds patience) {
        host_->server().add_service("/octoskin/" + word, type,
                                    [this, word, patience](std::string json, Reply reply) {
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
        answer ? daemon_.attend() : host_->view().on_lost(answer.error());
    });
}

void LiveView::run() {
    sources_.push_back(host_->loop().every(100ms, [this] { requests_.attend(); }));
    sources_.push_back(host_->loop().every(500ms, [this] { attend_daemon(); }));
    attend_daemon();
    host_->run();
    sources_.clear();
}

}  // namespace octoskin::view
