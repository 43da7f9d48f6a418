// What a daemon sends around a reload, and which rig the bridge has when it takes it.
#include "host/bridge/bridge/daemon_link.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/description.hpp"
#include "host/apps/daemon/settings.hpp"
#include "host/io/watch/map_changes.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::bridge {
namespace {

using namespace std::chrono_literals;

/// `description` with so many reloads.
std::string description(std::uint64_t reloads) {
    DaemonRequest request;
    request.rig = OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml";
    const auto settings = read_settings(request);
    EXPECT_TRUE(settings) << settings.error().error.message();
    return settings ? description_json(settings->host, true, reloads).dump() : std::string();
}

/// A control socket in a thread of its own that answers `describe` with 0 reloads until a client watches and
/// with `reloads` from then on. The watcher gets `frames`.
class ScriptedDaemon {
  public:
    ScriptedDaemon(const std::filesystem::path& socket, std::uint64_t reloads, std::string frames)
        : before_(description(0)),
          after_(description(reloads)),
          frames_("{\"ok\":true,\"watch\":1}\n" + std::move(frames)) {
        auto opened =
            ControlSocket::open(socket, loop_, [this](const std::string& line) { return answer(line); });
        EXPECT_TRUE(opened);
        control_ = std::move(opened).value();
        control_->hand_over(
            [this](const std::string& line, int connection) { return line == "watch" && show(connection); });
        end_ = loop_.every(5ms, [this] {
            if (is_ending_) loop_.stop(0);
        });
        thread_ = std::thread([this] { loop_.run(); });
    }
    ~ScriptedDaemon() {
        is_ending_ = true;
        thread_.join();
        if (watcher_ >= 0) ::close(watcher_);
    }
    ScriptedDaemon(const ScriptedDaemon&) = delete;
    ScriptedDaemon& operator=(const ScriptedDaemon&) = delete;

  private:
    std::string answer(const std::string& line) {
        if (line == "describe") return watcher_ < 0 ? before_ : after_;
        return R"({"ok":true})";
    }
    bool show(int connection) {
        watcher_ = connection;
        EXPECT_EQ(::send(connection, frames_.data(), frames_.size(), MSG_NOSIGNAL),
                  static_cast<ssize_t>(frames_.size()));
        return true;
    }

    std::string before_;
    std::string after_;
    std::string frames_;
    int watcher_ = -1;
    EventLoop loop_;
    std::unique_ptr<ControlSocket> control_;
    EventSource end_;
    std::atomic<bool> is_ending_ = false;
    std::thread thread_;
};

/// What it was given, in order.
class Listener final : public DaemonListener {
  public:
    void on_robot(RobotFacts robot) override { note("robot", robot.reloads); }
    void on_map(const watch::WatchedMap& map) override { note("map", map.time().ns); }
    void on_range(const watch::WatchedRange&, HostTime captured) override { note("range", captured.ns); }
    void on_joints(const watch::WatchedJoints&, HostTime sampled) override { note("joints", sampled.ns); }
    void on_status(const nlohmann::ordered_json&) override { note("status", 0); }
    void on_lost(const std::string&) override { note("lost", 0); }
    std::vector<std::string> given;

  private:
    template <class Number>
    void note(const char* what, Number number) {
        given.push_back(fmt::format("{} {}", what, number));
    }
};

std::string frame(watch::FrameHeader header, const std::string& payload) {
    std::string bytes;
    header.bytes = static_cast<std::uint32_t>(payload.size());
    watch::put_header(bytes, header);
    return bytes + payload;
}

std::string reload(std::uint64_t reloads) {
    return frame({.kind = watch::FrameKind::reload}, watch::reload_payload(reloads));
}

/// A range, a sample of the joints and a complete map of this time, and the status.
std::string all_kinds(std::int64_t time) {
    using watch::FrameKind;
    static FusedMap empty{MapConfig{}};
    watch::MissingBricks none;
    const std::string map = none.take(empty, 65'536);
    return frame({.kind = FrameKind::range, .time = {time}}, watch::range_payload(Beam{})) +
           frame({.kind = FrameKind::joints, .time = {time}}, watch::joints_payload(JointMeasurement{}, 1)) +
           frame({.kind = FrameKind::map, .flags = watch::kBegins | watch::kComplete, .time = {time}}, map) +
           frame({.kind = FrameKind::status}, R"({"problems":[]})");
}

class DaemonLinkTest : public testing::Test {
  protected:
    /// What the listener has after so many calls, or after 10 s.
    std::vector<std::string> given(std::uint64_t reloads, const std::string& frames, std::size_t calls) {
        const ScriptedDaemon daemon(folder_ / "control", reloads, frames);
        EventLoop loop;
        Listener listener;
        DaemonLink link(loop, folder_ / "control", listener, {.patience = 5s});  // a busy machine is slow
        link.attend();
        const auto end = std::chrono::steady_clock::now() + 10s;
        const EventSource look = loop.every(2ms, [&] {
            if (listener.given.size() >= calls || std::chrono::steady_clock::now() > end) loop.stop(0);
        });
        loop.run();
        outdated_ = link.outdated();
        return listener.given;
    }
    testing_support::ScratchFolder folder_;
    std::uint64_t outdated_ = 0;
};

TEST_F(DaemonLinkTest, has_the_rig_of_a_reload_before_the_next_frame) {
    const std::string frames = reload(0) + all_kinds(1) + reload(1) + all_kinds(2);
    EXPECT_EQ(given(1, frames, 10),
              (std::vector<std::string>{"robot 0", "range 1", "joints 1", "map 1", "status 0", "robot 1",
                                        "range 2", "joints 2", "map 2", "status 0"}));
    EXPECT_EQ(outdated_, 0U);
}

// The daemon may have reloaded since the client asked, before it watched.
TEST_F(DaemonLinkTest, asks_again_if_another_rig_came_before_the_first_frame) {
    EXPECT_EQ(given(3, reload(3) + all_kinds(1), 6),
              (std::vector<std::string>{"robot 0", "robot 3", "range 1", "joints 1", "map 1", "status 0"}));
}

// The description is newer than frames that wait: they are of a rig that is not known any more.
TEST_F(DaemonLinkTest, hands_on_nothing_of_a_rig_older_than_the_description) {
    const std::string frames = reload(0) + all_kinds(1) + reload(1) + all_kinds(2) + reload(2) + all_kinds(3);
    EXPECT_EQ(given(2, frames, 10),
              (std::vector<std::string>{"robot 0", "range 1", "joints 1", "map 1", "status 0", "robot 2",
                                        "range 3", "joints 3", "map 3", "status 0"}));
    EXPECT_EQ(outdated_, 4U);
}

TEST_F(DaemonLinkTest, ends_a_connection_whose_frames_do_not_say_which_rig_they_are_of) {
    const std::vector<std::string> lost{"robot 0", "lost 0"};
    EXPECT_EQ(given(0, all_kinds(1), 2), lost);
    EXPECT_EQ(given(0, frame({.kind = watch::FrameKind::reload}, "short"), 2), lost);
    EXPECT_EQ(given(0, reload(1) + all_kinds(1), 3),
              (std::vector<std::string>{"robot 0", "robot 0", "lost 0"}))
        << "the daemon describes a rig from before the reload";
}

}  // namespace
}  // namespace octoskin::bridge
