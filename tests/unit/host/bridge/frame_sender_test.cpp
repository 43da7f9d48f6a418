// Images on their way to a daemon that takes them, refuses them, stops reading or goes away.
#include "host/bridge/bridge/frame_sender.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/openni2/frame_pipe.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::bridge {
namespace {

using namespace std::chrono_literals;

constexpr openni2::FrameSize kSize{64, 48};
constexpr const char* kTaken = "{\"ok\":true}\n";

/// The daemon's end of one connection of a sender.
class Receiver {
  public:
    Receiver(int listener, const std::string& answer) {
        pollfd ready{listener, POLLIN, 0};
        EXPECT_EQ(::poll(&ready, 1, 5'000), 1) << "no connection";
        connection_ = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
        EXPECT_GE(connection_, 0);
        for (char next = 0; ::recv(connection_, &next, 1, 0) == 1 && next != '\n';) request += next;
        EXPECT_EQ(::send(connection_, answer.data(), answer.size(), MSG_NOSIGNAL),
                  static_cast<ssize_t>(answer.size()));
    }
    ~Receiver() { ::close(connection_); }
    Receiver(const Receiver&) = delete;
    Receiver& operator=(const Receiver&) = delete;

    /// The next frame; empty at the regular end. Fails the test if the stream breaks off.
    std::optional<openni2::PipedFrame> next() {
        auto frame = pipe().read_frame(kSize);
        EXPECT_TRUE(frame) << name(frame.error());
        return frame ? std::move(frame).value() : std::nullopt;
    }
    openni2::StreamHeader header() { return pipe().read_header().value(); }
    std::string request;

  private:
    openni2::FramePipe pipe() const { return openni2::FramePipe(connection_, 5s); }
    int connection_ = -1;
};

class FrameSenderTest : public testing::Test {
  protected:
    FrameSenderTest() : bound_(bind_unix_socket(folder_ / "control", SOCK_STREAM).value()) {}
    ~FrameSenderTest() override {
        bound_.file.remove();
        ::close(bound_.descriptor);
    }
    /// Its pixels all have the number.
    static DepthPixels image(std::uint16_t number) {
        return {kSize.width, kSize.height, std::vector<std::uint16_t>(kSize.pixels(), number)};
    }
    static void send(FrameSender& sender, std::uint16_t number) {
        sender.send(HostTime{std::int64_t{number} * 1'000'000}, image(number));
    }
    template <class IsSo>
    static bool wait_until(const FrameSender& sender, const IsSo& is_so) {
        for (int i = 0; i < 1'000; ++i) {
            if (is_so(sender.record())) return true;
            std::this_thread::sleep_for(5ms);
        }
        return false;
    }
    Receiver receive(const std::string& answer = kTaken) const { return {bound_.descriptor, answer}; }

    testing_support::ScratchFolder folder_;
    BoundSocket bound_;
};

TEST_F(FrameSenderTest, sends_each_image_with_its_time_and_an_end) {
    std::optional<FrameSender> sender(std::in_place, folder_ / "control", "left", 29.97);
    EXPECT_FALSE(sender->record().is_connected);
    send(*sender, 1);
    Receiver receiver = receive();
    EXPECT_EQ(receiver.request, "camera left");
    const openni2::StreamHeader header = receiver.header();
    EXPECT_EQ(header.size, kSize);
    EXPECT_EQ(header.rate_mhz, 29'970U);
    for (std::uint16_t number = 1; number <= 200; ++number) {
        const auto frame = receiver.next();
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->timestamp_us, number * 1'000U);
        EXPECT_EQ(frame->depth_mm, image(number).depth_mm);
        if (number < 200) send(*sender, static_cast<std::uint16_t>(number + 1));
    }
    EXPECT_TRUE(wait_until(*sender, [](const auto& record) { return record.sent == 200; }));
    EXPECT_TRUE(sender->record().is_connected);
    EXPECT_EQ(sender->record().displaced, 0U);
    sender.reset();
    EXPECT_FALSE(receiver.next()) << "the end";
}

TEST_F(FrameSenderTest, says_why_the_daemon_takes_none_and_asks_again) {
    FrameSender sender(folder_ / "control", "", 30.0);
    send(sender, 1);
    const Receiver refusing = receive("{\"ok\":false,\"error\":{\"message\":\"it has no camera\"}}\n");
    EXPECT_EQ(refusing.request, "camera");
    EXPECT_TRUE(wait_until(sender, [](const FrameSenderRecord& record) {
        return record.why.find("it has no camera") != std::string::npos;
    }));
    EXPECT_EQ(sender.record().sent, 0U);
    Receiver receiver = receive();
    EXPECT_EQ(receiver.header().size, kSize);
    EXPECT_EQ(receiver.next()->timestamp_us, 1'000U) << "the image has waited";
}

TEST_F(FrameSenderTest, connects_again_when_the_daemon_has_gone) {
    FrameSender sender(folder_ / "control", "", 30.0);
    send(sender, 1);
    {
        Receiver receiver = receive();
        (void)receiver.header();
        EXPECT_EQ(receiver.next()->timestamp_us, 1'000U);
    }
    std::uint16_t number = 1;
    EXPECT_TRUE(wait_until(sender, [&](const FrameSenderRecord& record) {
        if (record.is_connected) send(sender, ++number);
        return !record.is_connected && record.why.find("ended the connection") != std::string::npos;
    }));
    send(sender, 5'000);
    Receiver receiver = receive();
    (void)receiver.header();
    std::uint64_t newest = 0;
    while (newest < 5'000'000U) newest = receiver.next()->timestamp_us;
    EXPECT_EQ(newest, 5'000'000U);
}

// While the daemon reads nothing, the newest images wait; the others are counted.
TEST_F(FrameSenderTest, keeps_the_newest_images_and_counts_the_others) {
    FrameSender sender(folder_ / "control", "", 30.0);
    send(sender, 1);
    Receiver receiver = receive();
    constexpr std::uint16_t kLast = 2'000;  // 12 MB: more than a socket's buffer
    for (std::uint16_t number = 2; number <= kLast; ++number) send(sender, number);
    EXPECT_GT(sender.record().displaced, 0U);
    (void)receiver.header();
    std::uint64_t read = 0;
    std::uint64_t newest = 0;
    while (newest < kLast * 1'000U) {
        const auto frame = receiver.next();
        ASSERT_TRUE(frame);
        EXPECT_GT(frame->timestamp_us, newest);
        newest = frame->timestamp_us;
        ++read;
    }
    EXPECT_TRUE(wait_until(sender, [&](const auto& record) { return record.sent == read; }));
    EXPECT_EQ(sender.record().sent + sender.record().displaced, kLast);
}

TEST_F(FrameSenderTest, ends_within_two_seconds_whatever_the_daemon_does) {
    std::optional<FrameSender> sender(std::in_place, folder_ / "control", "", 30.0);
    send(*sender, 1);
    const Receiver silent = receive();
    for (std::uint16_t number = 2; number < 500; ++number) send(*sender, number);
    const auto begun = std::chrono::steady_clock::now();
    sender.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 2s + 500ms);
    sender.emplace(folder_ / "elsewhere", "", 30.0);
    send(*sender, 1);
    EXPECT_TRUE(wait_until(*sender, [](const auto& record) { return record.why != "no image yet"; }));
    EXPECT_FALSE(sender->record().is_connected);
}

}  // namespace
}  // namespace octoskin::bridge
