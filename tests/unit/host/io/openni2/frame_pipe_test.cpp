// The stream of frames between octoskin and its helpers, over a real socket. Oracle: the layout in
// frame_pipe.hpp, bytes written out here.
#include "host/io/openni2/frame_pipe.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <thread>

namespace octoskin::openni2 {
namespace {

using namespace std::string_view_literals;
using namespace std::chrono_literals;

/// Two ends of a socket; what one writes the other reads.
class FramePipeTest : public testing::Test {
  protected:
    FramePipeTest() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends_.data()), 0); }
    ~FramePipeTest() override {
        close_far_end();
        ::close(ends_[0]);
    }
    void close_far_end() {
        if (ends_[1] >= 0) ::close(ends_[1]);
        ends_[1] = -1;
    }
    void send(std::string_view bytes) {
        ASSERT_EQ(::write(ends_[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    }
    FramePipe near_end() const { return {ends_[0], 50ms}; }
    FramePipe far_end() const { return {ends_[1], 50ms}; }

    std::array<int, 2> ends_{-1, -1};
};

// 2 x 1 pixels, salvaged, 10 Hz; one frame at 0x0102 us with depths 0x0304 and 0x0506; the end.
constexpr std::string_view kStream =
    "OSKD\x04\0\0\0\x02\0\0\0\x01\0\0\0\x01\0\0\0\x10\x27\0\0"
    "\x02\x01\0\0\0\0\0\0\x04\x03\x06\x05"
    "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF"sv;

TEST_F(FramePipeTest, writes_the_documented_bytes) {
    const std::array<std::uint16_t, 2> depth{0x0304, 0x0506};
    ASSERT_TRUE(near_end().write_header({{2, 1}, true, 10'000}));
    ASSERT_TRUE(near_end().write_frame(0x0102, depth));
    ASSERT_TRUE(near_end().write_end());
    std::array<char, 100> bytes{};
    const ssize_t count = ::read(ends_[1], bytes.data(), bytes.size());
    EXPECT_EQ(std::string_view(bytes.data(), static_cast<std::size_t>(count)), kStream);
}

TEST_F(FramePipeTest, reads_the_documented_bytes) {
    send(kStream);
    const auto header = near_end().read_header();
    ASSERT_TRUE(header);
    EXPECT_EQ(header->size.width, 2U);
    EXPECT_EQ(header->rate_mhz, 10'000U);
    EXPECT_EQ(header->size.height, 1U);
    EXPECT_TRUE(header->is_salvaged);
    const auto frame = near_end().read_frame(header->size);
    ASSERT_TRUE(frame && frame->has_value());
    EXPECT_EQ((*frame)->timestamp_us, 0x0102U);
    EXPECT_EQ((*frame)->depth_mm, (std::vector<std::uint16_t>{0x0304, 0x0506}));
    const auto end = near_end().read_frame(header->size);
    ASSERT_TRUE(end);
    EXPECT_FALSE(end->has_value());
}

TEST_F(FramePipeTest, tells_a_frame_without_time_and_goes_on) {
    const std::array<std::uint16_t, 2> depth{7, 8};
    ASSERT_TRUE(far_end().write_untimed_frame());
    ASSERT_TRUE(far_end().write_frame(5, depth));
    const auto untimed = near_end().read_frame({2, 1});
    ASSERT_TRUE(untimed && untimed->has_value());
    EXPECT_FALSE((*untimed)->is_timed);
    const auto timed = near_end().read_frame({2, 1});
    ASSERT_TRUE(timed && timed->has_value());
    EXPECT_TRUE((*timed)->is_timed);
    EXPECT_EQ((*timed)->timestamp_us, 5U);
}

TEST_F(FramePipeTest, waits_no_longer_once_it_is_interrupted) {
    std::array<int, 2> interrupt{};
    ASSERT_EQ(::pipe(interrupt.data()), 0);
    FramePipe pipe(ends_[0], 10min, interrupt[0]);
    ASSERT_EQ(::write(interrupt[1], "x", 1), 1);
    const auto header = pipe.read_header();
    ASSERT_FALSE(header);
    EXPECT_EQ(header.error(), PipeError::interrupted);
    for (const int end : interrupt) ::close(end);
}

TEST_F(FramePipeTest, finds_every_cut_of_the_stream) {
    for (std::size_t length = 0; length < kStream.size(); ++length) {
        std::array<int, 2> ends{};
        ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
        ASSERT_EQ(::write(ends[1], kStream.data(), length), static_cast<ssize_t>(length));
        ::close(ends[1]);
        FramePipe pipe(ends[0], 50ms);
        std::optional<PipeError> error;
        if (const auto size = pipe.read_header(); !size) {
            error = size.error();
        } else if (const auto frame = pipe.read_frame(size->size); !frame) {
            error = frame.error();
        } else if (const auto end = pipe.read_frame(size->size); !end) {
            error = end.error();
        }
        EXPECT_EQ(error, PipeError::closed) << "cut to " << length << " bytes";
        ::close(ends[0]);
    }
}

TEST_F(FramePipeTest, refuses_another_format_version_or_an_impossible_size) {
    const std::string tail(8, '\0');
    for (const auto header : {"OSKE\x02\0\0\0\x02\0\0\0\x01\0\0\0"sv, "OSKD\x01\0\0\0\x02\0\0\0\x01\0\0\0"sv,
                              "OSKD\x04\0\0\0\0\0\0\0\x01\0\0\0"sv, "OSKD\x04\0\0\0\x02\0\0\0\0\0\0\0"sv,
                              "OSKD\x04\0\0\0\x01\x10\0\0\x01\0\0\0"sv,    // 4097 wide
                              "OSKD\x04\0\0\0\xD0\x07\0\0\xD0\x07\0\0"sv,  // 2000 x 2000
                              "OSKD\x04\0\0\0\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF"sv}) {
        send(std::string(header) + tail);
        const auto size = near_end().read_header();
        ASSERT_FALSE(size);
        EXPECT_EQ(size.error(), PipeError::wrong_format);
    }
}

TEST_F(FramePipeTest, does_not_wait_for_ever_for_data) {
    send(kStream.substr(0, 24));
    const auto size = near_end().read_header();
    ASSERT_TRUE(size);
    const auto frame = near_end().read_frame(size->size);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error(), PipeError::timeout);
}

// The patience is for all pixels of a frame, not for each byte.
TEST_F(FramePipeTest, does_not_wait_for_ever_for_a_frame_that_comes_in_drops) {
    send(kStream.substr(0, 32));  // up to the time of the frame
    const auto size = near_end().read_header();
    ASSERT_TRUE(size);
    std::jthread drops([this](const std::stop_token& end) {
        while (!end.stop_requested()) {
            send("x");
            std::this_thread::sleep_for(10ms);
        }
    });
    const auto frame = near_end().read_frame({64, 64});
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error(), PipeError::timeout);
}

TEST_F(FramePipeTest, reads_with_what_it_is_given_in_place_of_read) {
    send(kStream);
    FramePipe pipe(ends_[0], 50ms, -1, [](int descriptor, std::span<char> bytes) {
        return ::recv(descriptor, bytes.data(), std::min<std::size_t>(bytes.size(), 1), 0);
    });
    const auto header = pipe.read_header();
    ASSERT_TRUE(header);
    const auto frame = pipe.read_frame(header->size);
    ASSERT_TRUE(frame && frame->has_value());
    EXPECT_EQ((*frame)->depth_mm, (std::vector<std::uint16_t>{0x0304, 0x0506}));
}

TEST_F(FramePipeTest, does_not_wait_for_ever_for_somebody_who_does_not_read) {
    const std::vector<std::uint16_t> depth(512 * 424);
    std::optional<PipeError> error;
    for (int i = 0; i < 100 && !error; ++i) {
        if (const auto written = near_end().write_frame(1, depth); !written) error = written.error();
    }
    EXPECT_EQ(error, PipeError::timeout);
}

TEST_F(FramePipeTest, outlives_an_end_that_is_gone) {
    close_far_end();
    const auto written = near_end().write_end();  // SIGPIPE would end this test
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error(), PipeError::closed);
}

}  // namespace
}  // namespace octoskin::openni2
