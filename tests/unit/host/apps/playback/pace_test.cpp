#include "host/apps/playback/pace.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace octoskin {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

template <class Work>
Clock::duration time_of(const Work& work) {
    const auto begin = Clock::now();
    work();
    return Clock::now() - begin;
}

TEST(Pace, as_fast_as_it_goes_waits_for_nothing) {
    Pace pace;
    EXPECT_FALSE(pace.waits());
    EXPECT_LT(time_of([&] {
                  pace.wait(0);
                  pace.wait(3'600'000'000'000);
              }),
              1s);
}

TEST(Pace, waits_no_longer_because_those_before_were_late) {
    Pace pace = Pace::times(1.0);
    pace.wait(0);
    std::this_thread::sleep_for(50ms);
    EXPECT_LT(time_of([&] { pace.wait(40'000'000); }), 20ms) << "40 ms are over";
    EXPECT_GE(time_of([&] { pace.wait(120'000'000); }), 40ms) << "counted from the first, not the newest";
}

// A node that was silent for a day, a wall clock that was set.
TEST(Pace, begins_anew_where_the_time_leaps) {
    Pace pace = Pace::times(1.0);
    EXPECT_LT(time_of([&] {
                  pace.wait(0);
                  pace.wait(86'400'000'000'000);
                  pace.wait(86'400'000'000'000 + 1'000'000);
                  pace.wait(5);
                  pace.wait(1'000'005);
              }),
              1s);
}

TEST(Pace, by_step_asks_before_each) {
    std::vector<std::string> asked;
    Pace pace = Pace::by_step([&](const std::string& what) { asked.push_back(what); });
    EXPECT_TRUE(pace.waits());
    pace.wait(0, "one");
    pace.wait(3'600'000'000'000, "two");
    EXPECT_EQ(asked, (std::vector<std::string>{"one", "two"}));
}

/// Two frames 80 ms apart, then an error, again and again.
class TwoFrames final : public DepthSource {
  public:
    [[nodiscard]] Result<std::optional<DepthFrame>, Error> next() override {
        if (given_ == 2) return unexpected(Error{ErrorCode::damaged, "cut off"});
        return std::optional(DepthFrame{HostTime{7'000'000'000 + 80'000'000 * given_++}, 3, 2, {}});
    }

  private:
    std::int64_t given_ = 0;
};

TEST(PacedDepth, gives_each_frame_at_its_time_and_errors_at_once) {
    TwoFrames source;
    PacedDepth paced(source, Pace::times(2.0));
    EXPECT_EQ((*paced.next())->captured.ns, 7'000'000'000);
    EXPECT_GE(time_of([&] { EXPECT_EQ((*paced.next())->captured.ns, 7'080'000'000); }), 39ms);
    EXPECT_EQ(paced.next().error().what, "cut off");
    EXPECT_EQ(paced.next().error().what, "cut off");
}

TEST(PacedDepth, shows_each_frame_step_by_step) {
    TwoFrames source;
    std::vector<std::string> shown;
    PacedDepth paced(source, Pace::by_step([&](const std::string& what) { shown.push_back(what); }));
    ASSERT_TRUE(paced.next());
    ASSERT_TRUE(paced.next());
    EXPECT_FALSE(paced.next());
    EXPECT_EQ(shown, (std::vector<std::string>{"depth image 0 of 7.000000000: 3 x 2",
                                               "depth image 1 of 7.080000000: 3 x 2"}));
}

/// Two joint samples 3 s apart, the newer one 60 ms before a reading.
class ThreeCommits final : public CommitSource {
  public:
    [[nodiscard]] Result<std::optional<Commit>, Error> next() override {
        const std::int64_t place = given_++;
        if (place < 2) return std::optional<Commit>(JointMeasurement{HostTime{3'000'000'000 * place}, {}});
        return std::optional<Commit>(RangeMeasurement{{1, 0, 0}, HostTime{3'060'000'000}, 0.5, 0.01});
    }

  private:
    std::int64_t given_ = 0;
};

TEST(PacedCommits, waits_for_no_joint_sample_of_before_the_recording) {
    const auto play = [](std::optional<HostTime> begin) {
        ThreeCommits source;
        PacedCommits paced(source, Pace::times(1.0), begin);
        return time_of([&] {
            for (int i = 0; i < 3; ++i) EXPECT_TRUE(paced.next());
        });
    };
    EXPECT_LT(play(std::nullopt), 1s) << "begins with the reading";
    const auto from_joints = play(HostTime{2'990'000'000});
    EXPECT_GE(from_joints, 59ms);
    EXPECT_LT(from_joints, 1s);
}

}  // namespace
}  // namespace octoskin
