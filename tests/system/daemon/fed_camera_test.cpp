// A daemon whose camera another program feeds through the control socket, and what it tells such a program.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <csignal>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/openni2/frame_pipe.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"
#include "tests/system/said.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using testing_support::ScratchFolder;

constexpr openni2::FrameSize kSize{512, 424};

std::uint64_t monotonic_us() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000 +
           static_cast<std::uint64_t>(now.tv_nsec) / 1'000;
}

/// A program that feeds a camera with images of a narrow wall, which contradicts no range sensor: 3 m away,
/// and a millimetre more with each image.
class Feeder {
  public:
    Feeder(const std::filesystem::path& control, const std::string& request, openni2::FrameSize size = kSize)
        : socket_(connect_unix_socket(control, SOCK_STREAM).value()) {
        const std::string line = request + "\n";
        EXPECT_EQ(::send(socket_, line.data(), line.size(), MSG_NOSIGNAL), static_cast<ssize_t>(line.size()));
        const timeval patience{.tv_sec = 10, .tv_usec = 0};
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
        std::string text;
        for (char next = 0; ::recv(socket_, &next, 1, 0) == 1 && next != '\n';) text += next;
        answer = Json::parse(text, nullptr, false);
        EXPECT_TRUE(openni2::FramePipe(socket_, 5s).write_header({.size = size}));
    }
    ~Feeder() {
        thread_ = {};  // ended and joined before its socket goes
        ::close(socket_);
    }
    Feeder(const Feeder&) = delete;
    Feeder& operator=(const Feeder&) = delete;

    /// Ten images a second from now on.
    void feed() {
        thread_ = std::jthread([this](const std::stop_token& end) {
            openni2::FramePipe pipe(socket_, 5s);
            for (unsigned image = 0; !end.stop_requested(); ++image, std::this_thread::sleep_for(100ms))
                if (!pipe.write_frame(monotonic_us() - 20'000, wall(image))) return;
        });
    }
    /// The time of a frame and no pixels: it dies in mid-frame.
    void feed_half() const {
        const std::uint64_t time = monotonic_us();
        EXPECT_EQ(::send(socket_, &time, sizeof(time), MSG_NOSIGNAL), static_cast<ssize_t>(sizeof(time)));
    }

    Json answer = Json::object();

  private:
    static std::vector<std::uint16_t> wall(unsigned image) {
        constexpr std::size_t kColumns = 24;
        constexpr unsigned kDifferent = 40;  // images that repeat are not used
        std::vector<std::uint16_t> depth_mm(kSize.pixels(), 0);
        for (std::size_t i = 0; i < depth_mm.size(); ++i)
            if (i % kSize.width < kColumns)
                depth_mm[i] = static_cast<std::uint16_t>(3'000 + image % kDifferent);
        return depth_mm;
    }
    int socket_;
    std::jthread thread_;
};

class FedCamera : public DaemonTest {
  protected:
    static int used(const Json& now) { return now["inputs"]["depth frames"]["used"].get<int>(); }
    std::filesystem::path control() const { return folder_ / "control"; }
    Json describe() const {
        const auto answer = ask_daemon(control(), "describe");
        return answer ? Json::parse(*answer, nullptr, false) : Json();
    }
    void start_fed() {
        start({"--camera", "ros:/camera/depth"});
        ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return is_ranging(now); }, 20s))
            << daemon_->log();
    }
    bool wait_for_images(int more = 5) {
        const int before = used(daemon_->status());
        return daemon_->wait_until([&](const Json& now) { return used(now) >= before + more; }, 10s)
            .has_value();
    }
};

TEST_F(FedCamera, is_waited_for_fed_recorded_and_replayed_to_the_same_map) {
    start_fed();
    const auto waits = daemon_->wait_until(
        [](const Json& now) { return has_problem(now, "ros:/camera/depth: no program feeds it"); }, 10s);
    ASSERT_TRUE(waits) << daemon_->status()["problems"].dump(1);
    EXPECT_TRUE(has_problem(daemon_->status(), "octoskin bridge"));
    Feeder feeder(control(), "camera");
    EXPECT_EQ(feeder.answer, Json::parse(R"({"ok":true,"camera":"","width":512,"height":424})"));
    feeder.feed();
    ASSERT_TRUE(wait_for_images()) << daemon_->status()["inputs"].dump(1) << daemon_->log();
    EXPECT_TRUE(daemon_->wait_until([](const Json& now) { return now["problems"].empty(); }, 10s))
        << daemon_->status()["problems"].dump(1);
    const Json camera = daemon_->status()["cameras"][0];
    EXPECT_TRUE(camera["open"].get<bool>());
    EXPECT_EQ(camera["device"], "ros:/camera/depth");
    EXPECT_EQ(camera["untimed"], 0);
    EXPECT_EQ(camera["repeated"], 0);

    const std::string out = (folder_ / "recording").string();
    const Said recorded = octoskin("record " + out + " --seconds 4 --socket " + control().string());
    ASSERT_EQ(recorded.exit_code, 0) << recorded.output << daemon_->log();
    EXPECT_TRUE(daemon_->status()["recording"]["is_complete"].get<bool>());
    const Said replay = octoskin("replay " + out + " --fused-only");
    EXPECT_EQ(replay.exit_code, 0) << replay.output;
    EXPECT_NE(replay.output.find("identical to the daemon's, byte for byte"), std::string::npos)
        << replay.output;
    EXPECT_TRUE(ScratchFolder::read(out + "/maps/fused.ot") == ScratchFolder::read(out + "/last.ot"));
}

TEST_F(FedCamera, is_lost_by_name_and_comes_back_with_its_next_feeder) {
    start_fed();
    auto feeder = std::make_unique<Feeder>(control(), "camera");
    feeder->feed();
    ASSERT_TRUE(wait_for_images()) << daemon_->log();
    const Feeder second(control(), "camera");
    EXPECT_EQ(second.answer["error"]["code"], "in_use") << second.answer.dump();
    const Feeder stranger(control(), "camera left");
    EXPECT_EQ(stranger.answer["error"]["code"], "unknown_name") << stranger.answer.dump();
    ASSERT_TRUE(wait_for_images()) << "neither disturbs the first";

    feeder.reset();
    const auto reported = daemon_->wait_until(
        [](const Json& now) { return has_problem(now, "ros:/camera/depth: its feeder is gone"); }, 3s);
    ASSERT_TRUE(reported) << daemon_->status()["problems"].dump(1);
    EXPECT_LE(*reported, 1s);
    EXPECT_TRUE(has_problem(daemon_->status(), "camera_closed"));
    const Json before = daemon_->status();
    EXPECT_TRUE(daemon_->wait_until(
        [&](const Json& now) { return readings_used(now) > readings_used(before) + 100; }, 5s))
        << "the sensors go on";
    feeder = std::make_unique<Feeder>(control(), "camera");
    EXPECT_TRUE(feeder->answer["ok"].get<bool>()) << feeder->answer.dump();
    feeder->feed();
    EXPECT_TRUE(wait_for_images());
    feeder.reset();

    feeder = std::make_unique<Feeder>(control(), "camera", openni2::FrameSize{640, 480});
    EXPECT_TRUE(daemon_->wait_until(
        [](const Json& now) { return has_problem(now, "images of 640 x 480 pixels, the rig has 512 x 424"); },
        3s))
        << daemon_->status()["problems"].dump(1);
    feeder = std::make_unique<Feeder>(control(), "camera");
    EXPECT_TRUE(
        daemon_->wait_until([](const Json& now) { return now["cameras"][0]["open"].get<bool>(); }, 3s));
    feeder->feed_half();
    const auto stalled = daemon_->wait_until(
        [](const Json& now) { return has_problem(now, "its feeder sent no whole frame for 2 s"); }, 6s);
    EXPECT_TRUE(stalled) << daemon_->status()["problems"].dump(1);
}

TEST_F(FedCamera, is_described_and_follows_a_reload) {
    const auto write_rig = [&](const std::string& device) {
        return folder_.write(
            "rig.yaml", "extends: " + std::string(kExperiment) + "\ncamera: {device: '" + device + "'}\n");
    };
    const std::string film = (folder_ / "film.oni").string();
    folder_.write("film.oni", "not yet");
    start({}, write_rig(film));
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return is_ranging(now); }, 20s)) << daemon_->log();
    Json described = describe();
    ASSERT_TRUE(described.is_object() && described["ok"] == true) << described.dump();
    EXPECT_EQ(described["rig"], "experiment");
    EXPECT_EQ(described["base_link"], "panda_link0");
    EXPECT_EQ(described["sensors"].size(), 34U);
    EXPECT_EQ(described["cameras"][0]["is_fed"], false);
    EXPECT_EQ(described["reloads"], daemon_->status()["reloads"]["count"]);
    EXPECT_EQ(Feeder(control(), "camera").answer["error"]["code"], "unknown_name");

    (void)write_rig("ros:/camera/depth");
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_until(
        [&](const Json& now) { return now["reloads"]["count"] != described["reloads"]; }, 10s))
        << daemon_->log();
    described = describe();
    EXPECT_EQ(described["reloads"], daemon_->status()["reloads"]["count"]);
    EXPECT_EQ(described["cameras"][0]["is_fed"], true);
    EXPECT_EQ(described["cameras"][0]["device"], "ros:/camera/depth");
    Json answer = Json::object();
    std::unique_ptr<Feeder> feeder;
    for (int i = 0; i < 20 && !answer.value("ok", false); ++i, std::this_thread::sleep_for(100ms)) {
        feeder = std::make_unique<Feeder>(control(), "camera");  // the film may still be released
        answer = feeder->answer;
    }
    ASSERT_TRUE(answer.value("ok", false)) << answer.dump();
    feeder->feed();
    EXPECT_TRUE(wait_for_images()) << daemon_->status()["inputs"].dump(1) << daemon_->log();

    (void)write_rig(film);
    daemon_->signal(SIGHUP);
    EXPECT_TRUE(daemon_->wait_until(
        [&](const Json& now) {
            return now["cameras"][0]["device"] == film && !now["cameras"][0]["open"].get<bool>();
        },
        10s));
    EXPECT_EQ(describe()["cameras"][0]["is_fed"], false);
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(10s), 0) << daemon_->log();
}

TEST_F(FedCamera, does_not_keep_the_daemon_from_its_end) {
    start_fed();
    Feeder feeder(control(), "camera");
    feeder.feed_half();
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& now) { return now["cameras"][0]["open"].get<bool>(); }, 3s));
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
}

}  // namespace
}  // namespace octoskin::test
