// A film as a camera, played by the real OpenNI2 on a machine that has no time for it.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <thread>
#include <vector>

#include "host/io/openni2/frame_pipe.hpp"
#include "host/io/openni2/helper_process.hpp"
#include "host/io/openni2/oni_writer.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::openni2 {
namespace {

using namespace std::chrono_literals;

constexpr FrameSize kSize{64, 53};
constexpr std::int64_t kPeriodUs = 33'000;

std::int64_t monotonic_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// octoskin-camera with a film, of a hundred frames at 30 Hz.
class FilmCamera {
  public:
    explicit FilmCamera(const testing_support::ScratchFolder& folder) {
        const auto file = folder / "film.oni";
        auto writer = OniWriter::create(file, folder / "film.epoch.yaml", kSize);
        EXPECT_TRUE(writer) << writer.error().message();
        const std::vector<std::uint16_t> depth_mm(kSize.pixels(), 2'000);
        for (int i = 0; i < 100; ++i)
            EXPECT_TRUE(writer->write(HostTime{1'000'000'000 + 1'000 * kPeriodUs * i}, depth_mm));
        EXPECT_TRUE(writer->close());
        const auto helper = find_helper("octoskin-camera");
        EXPECT_TRUE(helper) << helper.error();
        std::array<int, 2> ends{};
        EXPECT_EQ(::pipe(ends.data()), 0);
        const std::string program = helper.value();
        process_ = ::fork();
        if (process_ == 0) {
            ::dup2(ends[1], STDOUT_FILENO);
            ::close(ends[0]);
            ::close(ends[1]);
            ::execl(program.c_str(), program.c_str(), file.c_str(), nullptr);
            ::_exit(127);
        }
        ::close(ends[1]);
        output_ = ends[0];
    }
    ~FilmCamera() {
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
        ::close(output_);
    }
    FilmCamera(const FilmCamera&) = delete;
    FilmCamera& operator=(const FilmCamera&) = delete;

    [[nodiscard]] int output() const { return output_; }
    /// It has the processor for a fifth of the time.
    void hold_up(const std::stop_token& end) const {
        while (!end.stop_requested()) {
            ::kill(process_, SIGSTOP);
            std::this_thread::sleep_for(60ms);
            ::kill(process_, SIGCONT);
            std::this_thread::sleep_for(15ms);
        }
    }

  private:
    pid_t process_ = -1;
    int output_ = -1;
};

// What is shown late is no late frame: the film runs late from then on, and later with each.
TEST(FilmTest, each_frame_has_the_time_at_which_it_is_shown_however_late_the_film_runs) {
    const testing_support::ScratchFolder folder;
    const FilmCamera camera(folder);
    FramePipe frames(camera.output(), 5s);
    const auto header = frames.read_header();
    ASSERT_TRUE(header) << name(header.error());
    ASSERT_TRUE(frames.read_frame(header->size));
    const std::jthread load([&](const std::stop_token& end) { camera.hold_up(end); });
    int untimed = 0;
    std::int64_t before_us = 0;
    std::vector<std::int64_t> late_us;  // this thread is late now and then itself
    std::optional<std::int64_t> first_us;
    constexpr int kFrames = 90;
    for (int i = 0; i < kFrames; ++i) {
        const auto frame = frames.read_frame(header->size);
        ASSERT_TRUE(frame) << name(frame.error());
        ASSERT_TRUE(frame->has_value());
        const std::int64_t arrived_us = monotonic_us();
        untimed += (*frame)->is_timed ? 0 : 1;
        if (!(*frame)->is_timed) continue;
        const auto captured_us = static_cast<std::int64_t>((*frame)->timestamp_us);
        EXPECT_GT(captured_us, before_us) << i;
        EXPECT_LE(captured_us, arrived_us) << i;
        before_us = captured_us;
        late_us.push_back(arrived_us - captured_us);
        first_us = first_us.value_or(captured_us);
    }
    ASSERT_EQ(untimed, 0);
    std::ranges::sort(late_us);
    const std::int64_t late_us_median = late_us[late_us.size() / 2];
    const std::int64_t lagged_us = before_us - first_us.value_or(0) - (kFrames - 1) * kPeriodUs;
    std::printf("the film lagged by %.2f s; half of the frames were over %.0f ms old when they came\n",
                1e-6 * static_cast<double>(lagged_us), 1e-3 * static_cast<double>(late_us_median));
    EXPECT_GT(lagged_us, 500'000) << "or this tests nothing";
    EXPECT_LE(late_us_median, 2 * kPeriodUs);
}

}  // namespace
}  // namespace octoskin::openni2
