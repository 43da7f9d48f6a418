// Cameras that behave and that do not: shell scripts in the helper's place.
#include "host/apps/daemon/camera_feed.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "host/apps/daemon/helper_frames.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Of a camera that a script reads in the helper's place.
class HelperFeed : public CameraFeed {
  public:
    HelperFeed(std::string uri, std::chrono::milliseconds silence_max, std::filesystem::path helper,
               std::optional<openni2::CameraMode> mode = {})
        : CameraFeed(std::make_unique<HelperFrames>(std::move(uri), silence_max, std::move(helper), mode),
                     silence_max) {}
};

class CameraFeedTest : public testing::Test {
  protected:
    std::filesystem::path camera(const std::string& script) {
        const auto program = scratch_.write("camera", "#!/bin/sh\n" + script + "\n");
        std::filesystem::permissions(program, std::filesystem::perms::owner_all);
        return program;
    }
    template <class Holds>
    static bool wait_until(const Holds& holds) {
        const auto end = Clock::now() + 5s;
        while (Clock::now() < end) {
            if (holds()) return true;
            std::this_thread::sleep_for(2ms);
        }
        return false;
    }
    testing_support::ScratchFolder scratch_;
};

// A header of 2 x 1 pixels at 10 Hz, as frame_pipe.hpp has it.
constexpr const char* kHeader =
    "printf 'OSKD\\004\\0\\0\\0\\002\\0\\0\\0\\001\\0\\0\\0\\0\\0\\0\\0\\020\\047\\0\\0'\n";
constexpr const char* kUntimed = "printf '\\376\\377\\377\\377\\377\\377\\377\\377'\n";
constexpr const char* kTimed = "printf '\\1\\0\\0\\0\\0\\0\\0\\0\\003\\004\\005\\006'\n";

TEST_F(CameraFeedTest, ends_at_once_while_its_camera_is_being_opened) {
    std::optional<HelperFeed> feed;
    feed.emplace("", 2s, camera("touch " + (scratch_ / "begun").string() + "; exec sleep 100"));
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(scratch_ / "begun"); }));
    const auto begun = Clock::now();
    feed.reset();
    EXPECT_LT(Clock::now() - begun, 2s);
}

TEST_F(CameraFeedTest, ends_at_once_while_its_camera_shows_nothing) {
    std::optional<HelperFeed> feed;
    feed.emplace("", 100s, camera(std::string(kHeader) + "exec sleep 100"));
    ASSERT_TRUE(wait_until([&] { return feed->record().is_open; }));
    const auto begun = Clock::now();
    feed.reset();
    EXPECT_LT(Clock::now() - begun, 2s);
}

TEST_F(CameraFeedTest, says_what_the_helper_says) {
    const HelperFeed feed("the-uri", 2s, camera("echo 'octoskin-camera: the reason' >&2; exit 1"));
    ASSERT_TRUE(wait_until([&] { return feed.record().why.find("the-uri") == 0; }));
    EXPECT_NE(feed.record().why.find("(octoskin-camera: the reason)"), std::string::npos)
        << feed.record().why;
    EXPECT_FALSE(feed.record().is_open);
}

TEST_F(CameraFeedTest, puts_what_the_helper_says_on_one_line_without_a_colon_at_its_end) {
    const HelperFeed feed("the-uri", 2s,
                          camera("printf 'octoskin-camera: too late:\\tby 5 s: \\n\\n' >&2; exit 1"));
    ASSERT_TRUE(wait_until([&] { return feed.record().why.find("the-uri") == 0; }));
    EXPECT_NE(feed.record().why.find("(octoskin-camera: too late: by 5 s)"), std::string::npos)
        << feed.record().why;
}

TEST_F(CameraFeedTest, tells_an_oni_file_that_is_not_there_from_one_that_is_none) {
    const auto failing = camera("exit 1");
    const std::string absent = (scratch_ / "nix.oni").string();
    const HelperFeed without_file(absent, 2s, failing);
    EXPECT_TRUE(wait_until([&] { return without_file.record().why == absent + ": no such file"; }))
        << without_file.record().why;
    const std::string broken = scratch_.write("broken.oni", "no depth").string();
    const HelperFeed with_file(broken, 2s, failing);
    EXPECT_TRUE(wait_until([&] {
        return with_file.record().why == broken + ": no .oni file with depth that OpenNI2 can play";
    })) << with_file.record().why;
}

TEST_F(CameraFeedTest, counts_frames_without_a_time_and_hands_over_the_others) {
    HelperFeed feed("", 100s, camera(std::string(kHeader) + kUntimed + kUntimed + kTimed + "exec sleep 100"));
    std::optional<DepthFrame> frame;
    ASSERT_TRUE(wait_until([&] { return (frame = feed.take()).has_value(); }));
    EXPECT_EQ(frame->captured, HostTime{1'000});
    EXPECT_EQ(frame->depth_mm, (std::vector<std::uint16_t>{0x0403, 0x0605}));
    EXPECT_EQ(feed.record().untimed, 2U);
    EXPECT_EQ(feed.record().frames, 3U);
    EXPECT_DOUBLE_EQ(feed.record().rate_hz, 10.0);
}

TEST_F(CameraFeedTest, ends_without_keeping_anybody_waiting_and_keeps_what_it_has_shown) {
    HelperFeed feed("", 100s, camera(std::string(kHeader) + kTimed + kTimed + "exec sleep 100"));
    ASSERT_TRUE(wait_until([&] { return feed.record().frames == 2; }));
    EXPECT_FALSE(feed.has_ended());
    const auto begun = Clock::now();
    feed.end();
    EXPECT_TRUE(feed.take());
    EXPECT_TRUE(feed.take());
    EXPECT_FALSE(feed.take());
    EXPECT_LT(Clock::now() - begun, 100ms);
    EXPECT_TRUE(wait_until([&] { return feed.has_ended(); }));
}

TEST_F(CameraFeedTest, keeps_the_newest_of_what_nobody_takes_and_counts_the_others) {
    std::string script = kHeader;
    for (int i = 1; i <= 5; ++i)
        script += "printf '\\" + std::to_string(i) + "\\0\\0\\0\\0\\0\\0\\0\\003\\004\\005\\006'\n";
    HelperFeed feed("", 100s, camera(script + "exec sleep 100"));
    ASSERT_TRUE(wait_until([&] { return feed.record().frames == 5; }));
    EXPECT_EQ(feed.record().displaced, 2U);
    for (const std::int64_t us : {3, 4, 5}) {
        const auto frame = feed.take();
        ASSERT_TRUE(frame) << us;
        EXPECT_EQ(frame->captured, HostTime{us * 1'000});
    }
    EXPECT_FALSE(feed.take());
}

std::string frame_at(int hundredths_s, char pixel) {
    std::string script = "printf '";
    for (std::int64_t us = std::int64_t{10'000} * hundredths_s, byte = 0; byte < 8; ++byte, us /= 256)
        script += fmt::format("\\{:03o}", us % 256);
    return script + fmt::format("\\000\\000\\{:03o}\\000'\n", static_cast<int>(pixel));
}

TEST_F(CameraFeedTest, hands_over_no_image_that_repeats_the_ones_before_for_long) {
    std::string script = kHeader;
    for (int i = 0; i < 10; ++i) script += frame_at(10 * i, 'a');  // from the 7th on
    script += frame_at(100, 'b');
    HelperFeed feed("", 100s, camera(script + "exec sleep 100"));
    std::vector<HostTime> taken;
    ASSERT_TRUE(wait_until([&] {
        while (const auto frame = feed.take()) taken.push_back(frame->captured);
        return feed.record().frames == 11 && !taken.empty() && taken.back() == HostTime{1'000'000'000};
    }));
    EXPECT_EQ(feed.record().repeated, 4U);
    EXPECT_TRUE(feed.record().newest_repeated);
    EXPECT_EQ(feed.record().opened, 1U);
}

TEST_F(CameraFeedTest, opens_a_camera_anew_that_repeats_an_image_unless_it_is_empty_or_a_film) {
    const auto repeating = [](char pixel) {
        std::string script = kHeader;
        for (int i = 0; i < 30; ++i) script += frame_at(10 * i, pixel);
        return script + "exec sleep 100";
    };
    HelperFeed hung("", 2s, camera(repeating('a')));
    EXPECT_TRUE(wait_until([&] { return hung.record().repeated > 0 && hung.record().opened > 1; }))
        << hung.record().opened;
    const HelperFeed covered("", 100s, camera(repeating('\0')));
    EXPECT_TRUE(wait_until([&] { return covered.record().frames == 30; }));
    EXPECT_EQ(covered.record().repeated, 24U);
    EXPECT_EQ(covered.record().opened, 1U);
    const HelperFeed film(scratch_.write("still.oni", "").string(), 100s, camera(repeating('a')));
    EXPECT_TRUE(wait_until([&] { return film.record().frames == 30; }));
    EXPECT_EQ(film.record().repeated, 0U);
}

// Opened anew it shows the same image, at times that go on, until it shows another one.
TEST_F(CameraFeedTest, hands_over_nothing_of_a_camera_that_hangs_though_it_is_opened_anew) {
    const std::string times = (scratch_ / "times").string();
    std::string first = kHeader;
    for (int i = 0; i < 30; ++i) first += frame_at(10 * i, 'a');
    std::string second = kHeader;
    for (int i = 0; i < 30; ++i) second += frame_at(400 + 10 * i, 'a');
    const std::string third = kHeader + frame_at(800, 'a') + frame_at(810, 'b');
    HelperFeed feed("", 2s,
                    camera("echo >> " + times + "\ncase $(wc -l < " + times + ") in\n1)\n" + first +
                           ";;\n2)\n" + second + ";;\n*)\n" + third + ";;\nesac\nexec sleep 100"));
    std::vector<HostTime> taken;
    ASSERT_TRUE(wait_until([&] {
        while (const auto frame = feed.take()) taken.push_back(frame->captured);
        return !taken.empty() && taken.back() == HostTime{8'100'000'000};
    }));
    EXPECT_EQ(feed.record().opened, 3U);
    EXPECT_EQ(feed.record().repeated, 16 + 22 + 1U) << "the second opening lasts as long as the first";
    EXPECT_EQ(taken.size() + feed.record().displaced, 6 + 1U);
}

// Each opening begins with an image of its own.
TEST_F(CameraFeedTest, hands_over_but_the_first_image_of_each_opening_of_a_camera_that_hangs) {
    const std::string times = (scratch_ / "times").string();
    std::string script = "echo >> " + times + "\ncase $(wc -l < " + times + ") in\n";
    for (int opening = 1; opening <= 2; ++opening) {
        script +=
            fmt::format("{})\n{}", opening, kHeader + frame_at(500 * opening, static_cast<char>(opening)));
        for (int i = 1; i < 30; ++i) script += frame_at(500 * opening + 10 * i, 'a');
        script += ";;\n";
    }
    script += std::string("*)\n") + kHeader + frame_at(2000, 'b') + ";;\nesac\nexec sleep 100";
    HelperFeed feed("", 2s, camera(script));
    std::vector<HostTime> taken;
    ASSERT_TRUE(wait_until([&] {
        while (const auto frame = feed.take()) taken.push_back(frame->captured);
        return !taken.empty() && taken.back() == HostTime{20'000'000'000};
    }));
    EXPECT_EQ(feed.record().opened, 3U);
    EXPECT_EQ(taken.size() + feed.record().displaced, 1 + 6 + 1 + 1U);
    EXPECT_TRUE(feed.record().repeats_often);
}

TEST_F(CameraFeedTest, opens_a_camera_anew_that_repeats_an_image_though_one_in_ten_differs) {
    std::string script = kHeader;
    for (int i = 0; i < 40; ++i) script += frame_at(10 * i, static_cast<char>(i % 10 == 9 ? i : 'a'));
    HelperFeed feed("", 2s, camera(script + "exec sleep 100"));
    EXPECT_TRUE(wait_until([&] { return feed.record().opened > 1; }));
    EXPECT_TRUE(feed.record().repeats_often);
}

TEST_F(CameraFeedTest, tells_the_helper_which_camera_and_which_mode) {
    const std::string reported = (scratch_ / "told").string();
    const auto program =
        camera("echo \"$# $1 $2\" > " + reported + ".new; mv " + reported + ".new " + reported);
    const auto wait_for = [&](const std::string& words) {
        return wait_until([&] { return testing_support::ScratchFolder::read(reported) == words + "\n"; });
    };
    std::optional<HelperFeed> feed;
    feed.emplace("the-uri", 2s, program, openni2::CameraMode{640, 480, 30.0});
    EXPECT_TRUE(wait_for("2 the-uri 640x480@30"));
    feed.reset();
    feed.emplace("the-uri", 2s, program);
    EXPECT_TRUE(wait_for("1 the-uri "));
}

}  // namespace
}  // namespace octoskin
