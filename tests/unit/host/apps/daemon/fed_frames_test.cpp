// Cameras that a program feeds: feeders that behave and that do not, at the other end of a connection.
#include "host/apps/daemon/fed_frames.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "host/apps/daemon/camera_feed.hpp"
#include "host/apps/daemon/clocks.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr openni2::FrameSize kSize{2, 1};

std::uint64_t now_us() {
    return static_cast<std::uint64_t>(monotonic_now().ns / 1000);
}

std::string bytes_of(const void* from, std::size_t count) {
    std::string bytes(count, '\0');
    std::memcpy(bytes.data(), from, count);
    return bytes;
}

/// Written out as frame_pipe.hpp has it.
std::string header(openni2::FrameSize size = kSize, std::uint32_t rate_mhz = 10'000) {
    const std::array<std::uint32_t, 5> numbers{4, size.width, size.height, 0, rate_mhz};
    return "OSKD" + bytes_of(numbers.data(), sizeof(numbers));
}
std::string frame(std::uint64_t timestamp_us, std::uint16_t depth_mm = 0x0403) {
    const std::array<std::uint16_t, 2> pixels{depth_mm, static_cast<std::uint16_t>(depth_mm + 0x0202)};
    return bytes_of(&timestamp_us, sizeof(timestamp_us)) + bytes_of(pixels.data(), sizeof(pixels));
}
std::string mark(std::uint64_t value) {
    return bytes_of(&value, sizeof(value));
}
const std::string kEndMark = mark(~std::uint64_t{0});
const std::string kUntimedMark = mark(~std::uint64_t{0} - 1);

template <class Holds>
bool wait_until(const Holds& holds) {
    const auto end = Clock::now() + 5s;
    while (Clock::now() < end) {
        if (holds()) return true;
        std::this_thread::sleep_for(2ms);
    }
    return false;
}

/// A program's end of a connection.
class Feeder {
  public:
    explicit Feeder(FedFrames& frames) {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()), 0);
        end_ = ends[0];
        is_taken = frames.take(ends[1]);
        if (!is_taken) ::close(ends[1]);
    }
    ~Feeder() { leave(); }
    Feeder(const Feeder&) = delete;
    Feeder& operator=(const Feeder&) = delete;

    void send(std::string_view bytes) const {
        EXPECT_EQ(::send(end_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
    }
    void try_to_send(std::string_view bytes) const {
        (void)::send(end_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    }
    void leave() {
        if (end_ >= 0) ::close(std::exchange(end_, -1));
    }
    /// The daemon has closed the connection.
    [[nodiscard]] bool is_closed() const {
        char byte = 0;
        const ssize_t got = ::recv(end_, &byte, 1, MSG_DONTWAIT);
        return got == 0 || (got < 0 && errno == ECONNRESET);
    }
    bool is_taken = false;

  private:
    int end_ = -1;
};

class FedFramesTest : public testing::Test {
  protected:
    void begin(std::chrono::milliseconds silence_max = 100s, openni2::FrameSize size = kSize) {
        auto source = std::make_unique<FedFrames>("ros:/depth", size, silence_max);
        frames_ = source.get();
        feed_.emplace(std::move(source), silence_max);
    }
    [[nodiscard]] bool is_closed_because(const std::string& part) const {
        return wait_until([&] {
            const CameraRecord record = feed_->record();
            return !record.is_open && record.why.find(part) != std::string::npos;
        });
    }
    [[nodiscard]] bool is_free() const {
        return wait_until([&] { return frames_->feeder().empty(); });
    }
    /// Takes what arrives; the time of the newest.
    [[nodiscard]] std::optional<DepthFrame> next() {
        std::optional<DepthFrame> taken;
        (void)wait_until([&] { return (taken = feed_->take()).has_value(); });
        return taken;
    }
    FedFrames* frames_ = nullptr;
    std::optional<CameraFeed> feed_;
};

TEST_F(FedFramesTest, wait_for_a_program_and_say_which_one_it_may_be) {
    begin();
    EXPECT_FALSE(feed_->record().is_open);
    EXPECT_EQ(feed_->record().why, "ros:/depth: no program feeds it");
    EXPECT_NE(feed_->record().remedy.find("octoskin bridge"), std::string::npos);
    EXPECT_EQ(frames_->feeder(), "");
}

TEST_F(FedFramesTest, are_handed_over_with_the_feeders_times) {
    begin();
    const Feeder feeder(*frames_);
    ASSERT_TRUE(feeder.is_taken);
    const std::uint64_t first = now_us() - 20'000;
    feeder.send(header() + kUntimedMark + frame(first) + frame(first + 10'000, 0x0807));
    const auto taken = next();
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->captured, HostTime{static_cast<std::int64_t>(first) * 1000});
    EXPECT_EQ(taken->width, 2U);
    EXPECT_EQ(taken->depth_mm, (std::vector<std::uint16_t>{0x0403, 0x0605}));
    ASSERT_TRUE(next());
    const CameraRecord record = feed_->record();
    EXPECT_TRUE(record.is_open);
    EXPECT_EQ(record.why, "");
    EXPECT_DOUBLE_EQ(record.rate_hz, 10.0);
    EXPECT_EQ(record.frames, 3U);
    EXPECT_EQ(record.untimed, 1U);
}

TEST_F(FedFramesTest, have_one_feeder_who_is_named_to_a_second) {
    begin();
    const Feeder feeder(*frames_);
    const Feeder at_once(*frames_);  // the first has sent nothing yet
    EXPECT_FALSE(at_once.is_taken);
    feeder.send(header());
    ASSERT_TRUE(wait_until([&] { return feed_->record().is_open; }));
    const Feeder second(*frames_);
    EXPECT_FALSE(second.is_taken);
    EXPECT_NE(frames_->feeder().find(fmt::format("process {}", ::getpid())), std::string::npos)
        << frames_->feeder();
    feeder.send(frame(now_us()));
    EXPECT_TRUE(next()) << "the first goes on";
}

TEST_F(FedFramesTest, come_back_at_once_with_the_next_feeder) {
    begin();
    for (std::uint64_t opened = 1; opened <= 5; ++opened) {
        Feeder feeder(*frames_);
        ASSERT_TRUE(feeder.is_taken) << opened;
        feeder.send(header() + frame(now_us(), static_cast<std::uint16_t>(opened)));
        ASSERT_TRUE(next());
        EXPECT_EQ(feed_->record().opened, opened);
        if (opened % 2 == 0) feeder.send(kEndMark);
        if (opened == 3) feeder.send(frame(now_us()).substr(0, 9));
        feeder.leave();
        const auto begun = Clock::now();
        const Feeder another(*frames_);
        EXPECT_TRUE(another.is_taken) << "the former one has gone, whether or not that was noticed";
        EXPECT_LT(Clock::now() - begun, 500ms);
    }
    EXPECT_TRUE(is_closed_because("ros:/depth: its feeder is gone"));
}

TEST_F(FedFramesTest, tell_an_end_from_a_feeder_that_died) {
    begin();
    const Feeder ended(*frames_);
    ended.send(header() + kEndMark);
    EXPECT_TRUE(is_closed_because("ros:/depth: its feeder has ended")) << feed_->record().why;
    EXPECT_TRUE(wait_until([&] { return ended.is_closed(); }));
    ASSERT_TRUE(is_free());
    Feeder died(*frames_);
    died.send(header() + frame(now_us()).substr(0, 10));
    died.leave();
    EXPECT_TRUE(is_closed_because("ros:/depth: its feeder is gone")) << feed_->record().why;
}

TEST_F(FedFramesTest, survive_a_stream_that_is_cut_anywhere) {
    const std::string whole = header() + frame(now_us()) + kEndMark;
    for (std::size_t length = 0; length < whole.size(); ++length) {
        begin();
        Feeder feeder(*frames_);
        ASSERT_TRUE(feeder.is_taken) << length;
        feeder.send(whole.substr(0, length));
        feeder.leave();
        ASSERT_TRUE(is_closed_because("ros:/depth: its feeder is gone")) << length << feed_->record().why;
        EXPECT_EQ(feed_->record().opened, length < header().size() ? 0U : 1U) << length;
        EXPECT_EQ(feed_->record().frames, length < whole.size() - kEndMark.size() ? 0U : 1U) << length;
        const Feeder next_one(*frames_);
        next_one.send(header() + frame(now_us(), 7));
        EXPECT_TRUE(wait_until([&] {
            const auto taken = feed_->take();
            return taken && taken->depth_mm[0] == 7;
        })) << length;
    }
}

TEST_F(FedFramesTest, refuse_another_size_and_name_both) {
    begin(100s, {640, 480});
    const Feeder feeder(*frames_);
    feeder.send(header({320, 240}));
    EXPECT_TRUE(is_closed_because("its feeder sends images of 320 x 240 pixels, the rig has 640 x 480"))
        << feed_->record().why;
    EXPECT_TRUE(wait_until([&] { return feeder.is_closed(); }));
    EXPECT_EQ(feed_->record().opened, 0U);
}

TEST_F(FedFramesTest, refuse_what_is_no_stream) {
    begin();
    const std::uint32_t huge = std::numeric_limits<std::uint32_t>::max();
    std::string other_version = header();
    other_version[4] = 3;
    for (const std::string& bytes : {std::string("GET / HTTP/1.1\r\nHost: a\r\n\r\n"), other_version,
                                     header({0, 1}), header({2, 0}), header({huge, huge}), header({huge, 1}),
                                     header({4096, 4096}), header({4097, 1}), std::string(24, '\0')}) {
        const Feeder feeder(*frames_);
        ASSERT_TRUE(feeder.is_taken);
        feeder.send(bytes);
        EXPECT_TRUE(is_closed_because("is no stream of depth frames of at most 1920000 pixels"))
            << feed_->record().why;
        EXPECT_TRUE(wait_until([&] { return feeder.is_closed(); }));
        ASSERT_TRUE(is_free());
    }
    EXPECT_EQ(feed_->record().opened, 0U);
}

// The size of the images is the rig's: more bytes are the beginning of the next frame.
TEST_F(FedFramesTest, read_frames_larger_than_the_header_says_as_further_frames) {
    begin();
    const Feeder feeder(*frames_);
    feeder.send(header() + frame(now_us()) + std::string(12, '\x7F') + frame(now_us(), 9));
    ASSERT_TRUE(wait_until([&] { return feed_->record().frames == 3; }));
    EXPECT_EQ(feed_->record().untimed, 1U) << "0x7F7F... is no time";
}

TEST_F(FedFramesTest, count_frames_from_the_past_and_the_future_as_untimed) {
    begin();
    const Feeder feeder(*frames_);
    const std::uint64_t now = now_us();
    constexpr std::uint64_t kMax = std::numeric_limits<std::uint64_t>::max();
    const std::vector<std::uint64_t> wrong{0,           1,        now - 600'000,  now + 5'000'000,
                                           kMax - 2,    kMax / 2, kMax / 1000,    kMax / 1000 + 1,
                                           kMax / 2000, kMax / 4, kMax / 2000 + 1};
    std::string stream = header();
    for (const std::uint64_t time : wrong) stream += frame(time);
    feeder.send(stream + frame(now, 5));
    const auto taken = next();
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->captured, HostTime{static_cast<std::int64_t>(now) * 1000});
    EXPECT_FALSE(feed_->take());
    EXPECT_EQ(feed_->record().untimed, wrong.size());
    EXPECT_TRUE(feed_->record().is_open);
}

TEST(FedFramesTime, is_that_of_the_arrival_or_a_little_before) {
    constexpr std::uint64_t kNow = 1'000'000'000;
    EXPECT_TRUE(FedFrames::is_timely(kNow, kNow));
    EXPECT_TRUE(FedFrames::is_timely(kNow - 500'000, kNow));
    EXPECT_FALSE(FedFrames::is_timely(kNow - 500'001, kNow));
    EXPECT_TRUE(FedFrames::is_timely(kNow + 50'000, kNow)) << "clocks that were compared differ by a little";
    EXPECT_FALSE(FedFrames::is_timely(kNow + 50'001, kNow));
    EXPECT_FALSE(FedFrames::is_timely(std::numeric_limits<std::uint64_t>::max(), kNow));
    EXPECT_FALSE(FedFrames::is_timely(0, kNow));
}

TEST_F(FedFramesTest, close_a_feeder_that_is_silent) {
    begin(200ms);
    const Feeder says_nothing(*frames_);
    EXPECT_TRUE(is_closed_because("ros:/depth: its feeder sent no header of a stream for 0.2 s"))
        << feed_->record().why;
    EXPECT_TRUE(wait_until([&] { return says_nothing.is_closed(); }));
    ASSERT_TRUE(is_free());
    const Feeder stops(*frames_);
    stops.send(header() + frame(now_us()));
    EXPECT_TRUE(next());
    EXPECT_TRUE(is_closed_because("ros:/depth: its feeder sent no whole frame for 0.2 s"))
        << feed_->record().why;
    EXPECT_TRUE(wait_until([&] { return stops.is_closed(); }));
}

TEST_F(FedFramesTest, close_a_feeder_that_stalls_in_mid_frame_though_it_sends_a_byte_now_and_then) {
    constexpr openni2::FrameSize kLarge{64, 64};
    begin(200ms, kLarge);
    const Feeder feeder(*frames_);
    feeder.send(header(kLarge) + mark(now_us()));
    const auto begun = Clock::now();
    while (!feeder.is_closed() && Clock::now() - begun < 5s) {
        feeder.try_to_send("x");
        std::this_thread::sleep_for(5ms);
    }
    EXPECT_LT(Clock::now() - begun, 2s);
    EXPECT_TRUE(is_closed_because("its feeder sent no whole frame for 0.2 s")) << feed_->record().why;
}

TEST_F(FedFramesTest, close_a_feeder_whose_images_repeat) {
    begin(600ms);
    const Feeder feeder(*frames_);
    feeder.send(header());
    for (int i = 0; i < 40 && !feeder.is_closed(); ++i) {
        feeder.send(frame(now_us()));
        std::this_thread::sleep_for(50ms);
    }
    EXPECT_TRUE(is_closed_because("ros:/depth: it shows one image again and again")) << feed_->record().why;
    EXPECT_GT(feed_->record().repeated, 0U);
}

TEST_F(FedFramesTest, end_at_once_whatever_the_feeder_does) {
    const std::string half = header() + frame(now_us()).substr(0, 9);
    for (const std::string& sent : {std::string(), header().substr(0, 7), header(), half}) {
        begin();
        const Feeder feeder(*frames_);
        feeder.send(sent);
        if (sent.size() >= header().size()) {
            ASSERT_TRUE(wait_until([&] { return feed_->record().is_open; }));
        }
        const auto begun = Clock::now();
        feed_.reset();
        EXPECT_LT(Clock::now() - begun, 1s);
        EXPECT_TRUE(feeder.is_closed());
    }
}

TEST_F(FedFramesTest, close_a_connection_that_they_never_opened) {
    auto frames = std::make_unique<FedFrames>("ros:/depth", kSize, 1s);
    const Feeder feeder(*frames);
    EXPECT_TRUE(feeder.is_taken);
    EXPECT_FALSE(feeder.is_closed());
    frames.reset();
    EXPECT_TRUE(feeder.is_closed());
}

// Feeders come and go from one thread while another reads.
TEST_F(FedFramesTest, take_turns_of_many_feeders) {
    begin();
    int taken = 0;
    for (int i = 0; i < 200; ++i) {
        Feeder feeder(*frames_);
        taken += feeder.is_taken ? 1 : 0;
        feeder.send(feeder.is_taken ? header() + frame(now_us(), static_cast<std::uint16_t>(i)) : "");
        (void)frames_->feeder();
    }
    EXPECT_EQ(taken, 200) << "each had gone when the next came";
    const Feeder last(*frames_);
    ASSERT_TRUE(last.is_taken);
    last.send(header() + frame(now_us(), 999));
    EXPECT_TRUE(wait_until([&] {
        const auto frame = feed_->take();
        return frame && frame->depth_mm[0] == 999;
    }));
}

}  // namespace
}  // namespace octoskin
