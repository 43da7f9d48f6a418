// Programs that ask to feed a camera: who may, who is refused, and what a reload changes.
#include "host/apps/daemon/feeder_request.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "host/apps/daemon/clocks.hpp"
#include "host/io/openni2/frame_pipe.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

HostCamera camera(const std::string& name, const std::string& device, std::uint32_t width = 2) {
    HostCamera camera;
    camera.name = name;
    camera.device = device;
    camera.intrinsics.width = width;
    camera.intrinsics.height = 1;
    return camera;
}

/// A connection of the control socket, whose client is the test.
class Connection {
  public:
    Connection() {
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends_.data()), 0);
    }
    ~Connection() {
        for (const int end : ends_)
            if (end >= 0) ::close(end);
    }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    bool ask(CameraInputs& cameras, const std::string& line) {
        const bool is_taken = take_feeder(cameras, line, ends_[1]);
        if (is_taken) ends_[1] = -1;  // it closes it
        return is_taken;
    }
    std::string line() const {
        std::string text;
        for (char next = 0; ::recv(ends_[0], &next, 1, 0) == 1 && next != '\n';) text += next;
        return text;
    }
    void send_image(std::uint32_t width) const {
        openni2::FramePipe pipe(ends_[0], 1s);
        EXPECT_TRUE(pipe.write_header({.size = {width, 1}}));
        const std::vector<std::uint16_t> depth_mm(width, 1'000);
        EXPECT_TRUE(pipe.write_frame(static_cast<std::uint64_t>(monotonic_now().ns / 1000), depth_mm));
    }
    bool is_closed_within(std::chrono::milliseconds patience) const {
        pollfd look{ends_[0], 0, 0};
        const auto end = std::chrono::steady_clock::now() + patience;
        while (std::chrono::steady_clock::now() < end) {
            if (::poll(&look, 1, 0) > 0 && (look.revents & POLLHUP) != 0) return true;
            std::this_thread::sleep_for(2ms);
        }
        return false;
    }

  private:
    std::array<int, 2> ends_{-1, -1};
};

class FeederRequest : public testing::Test {
  protected:
    void reload(const std::vector<HostCamera>& cameras) {
        cameras_.release_others(cameras);
        cameras_.want(cameras);
    }
    Json refusal(const std::string& name) const { return Json::parse(feeder_refusal(cameras_, name)); }
    /// The first camera.
    bool is_open_within(std::chrono::milliseconds patience) const {
        const auto end = std::chrono::steady_clock::now() + patience;
        while (std::chrono::steady_clock::now() < end && !cameras_.records()[0].is_open)
            std::this_thread::sleep_for(2ms);
        return cameras_.records()[0].is_open;
    }
    /// The next frame that the loop takes; empty: none within 5 s. At most once: the loop ends.
    std::optional<DepthFrame> next() {
        frames_.clear();
        const auto end = std::chrono::steady_clock::now() + 5s;
        const EventSource look = loop_.every(5ms, [&] {
            cameras_.attend();
            if (!frames_.empty() || std::chrono::steady_clock::now() > end) loop_.stop(0);
        });
        loop_.run();
        return frames_.empty() ? std::nullopt : std::optional(frames_.front());
    }
    EventLoop loop_;
    std::vector<DepthFrame> frames_;
    CameraInputs cameras_{loop_, [this](DepthFrame frame) {
                              frames_.push_back(std::move(frame));
                              return true;
                          }};
};

TEST_F(FeederRequest, is_one_word_and_perhaps_a_name) {
    EXPECT_EQ(fed_camera_of("camera"), "");
    EXPECT_EQ(fed_camera_of("camera "), "");
    EXPECT_EQ(fed_camera_of("camera front"), "front");
    for (const char* other : {"", "cameras", "Camera", "status", " camera", "came"})
        EXPECT_FALSE(fed_camera_of(other)) << other;
    Connection connection;
    EXPECT_FALSE(connection.ask(cameras_, "status"));
}

TEST_F(FeederRequest, is_answered_with_the_size_and_the_images_come_in) {
    reload({camera("left", "none.oni"), camera("right", "ros:/depth", 3)});
    Connection connection;
    ASSERT_TRUE(connection.ask(cameras_, "camera right"));
    EXPECT_EQ(connection.line(), R"({"ok":true,"camera":"right","width":3,"height":1})");
    connection.send_image(3);
    const auto frame = next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->camera, 1) << "its index in the rig";
    EXPECT_EQ(frame->width, 3U);
    EXPECT_TRUE(cameras_.records()[1].is_open);
    EXPECT_FALSE(cameras_.records()[0].is_open);
}

TEST_F(FeederRequest, needs_no_name_for_a_camera_without_one) {
    reload({camera("", "ros:/depth")});
    Connection connection;
    ASSERT_TRUE(connection.ask(cameras_, "camera"));
    EXPECT_EQ(connection.line(), R"({"ok":true,"camera":"","width":2,"height":1})");
}

TEST_F(FeederRequest, is_refused_for_a_camera_that_is_unknown_or_not_fed) {
    reload({camera("left", "none.oni"), camera("right", "ros:/depth"), camera("top", "ros:/top")});
    for (const std::string name : {"", "Right", "right ", "left", "no\xFFtext"}) {
        Connection connection;
        EXPECT_FALSE(connection.ask(cameras_, "camera " + name)) << name;
        const Json refused = refusal(name);
        EXPECT_EQ(refused["ok"], false);
        EXPECT_EQ(refused["exit"], 64);
        EXPECT_EQ(refused["error"]["code"], "unknown_name") << name;
        EXPECT_EQ(refused["error"]["remedy"], "there are: right, top") << name;
    }
    EXPECT_EQ(refusal("left")["error"]["value"], "'none.oni'");
    reload({camera("", "none.oni")});
    EXPECT_NE(refusal("")["error"]["remedy"].get<std::string>().find("ros:/TOPIC"), std::string::npos);
    reload({});
    EXPECT_EQ(refusal("")["error"]["code"], "unknown_name");
}

TEST_F(FeederRequest, is_refused_while_another_program_feeds_it) {
    reload({camera("left", "ros:/left"), camera("right", "ros:/right")});
    std::optional<Connection> first(std::in_place);
    ASSERT_TRUE(first->ask(cameras_, "camera right"));
    Connection second;
    EXPECT_FALSE(second.ask(cameras_, "camera right"));
    const Json refused = refusal("right");
    EXPECT_EQ(refused["exit"], 69);
    EXPECT_EQ(refused["error"]["code"], "in_use");
    const auto message = refused["error"]["message"].get<std::string>();
    EXPECT_NE(message.find("camera 'right'"), std::string::npos) << message;
    EXPECT_NE(message.find("process " + std::to_string(::getpid())), std::string::npos) << message;
    EXPECT_TRUE(second.ask(cameras_, "camera left")) << "the other is free";
    first.reset();
    Connection third;
    EXPECT_TRUE(third.ask(cameras_, "camera right"));
    EXPECT_EQ(refusal("left")["error"]["code"], "in_use");
}

TEST_F(FeederRequest, follows_a_reload_from_and_to_a_device_that_is_fed) {
    reload({camera("front", "none.oni")});
    Connection early;
    EXPECT_FALSE(early.ask(cameras_, "camera front"));
    reload({camera("front", "ros:/depth")});
    Connection connection;
    ASSERT_TRUE(connection.ask(cameras_, "camera front"));
    connection.send_image(2);
    EXPECT_TRUE(is_open_within(5s));
    reload({camera("front", "ros:/depth")});
    EXPECT_FALSE(connection.is_closed_within(50ms)) << "nothing changed for it";
    reload({camera("front", "ros:/depth", 4)});
    EXPECT_TRUE(connection.is_closed_within(2s)) << "images of another size";
    // The former one may still hold the device.
    Connection wider;
    bool is_taken = false;
    for (int i = 0; i < 100 && !is_taken; ++i) {
        cameras_.attend();
        is_taken = wider.ask(cameras_, "camera front");
        std::this_thread::sleep_for(10ms);
    }
    ASSERT_TRUE(is_taken);
    EXPECT_EQ(wider.line(), R"({"ok":true,"camera":"front","width":4,"height":1})");
    reload({camera("front", "none.oni")});
    EXPECT_TRUE(wider.is_closed_within(2s));
    EXPECT_EQ(refusal("front")["error"]["code"], "unknown_name");
}

}  // namespace
}  // namespace octoskin
