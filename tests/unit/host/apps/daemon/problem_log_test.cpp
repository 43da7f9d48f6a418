#include "host/apps/daemon/problem_log.hpp"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <sstream>

namespace octoskin {
namespace {

/// A problem whose sentence is "ON: WHAT", or WHAT if `on` is empty.
Problem problem_of(ProblemCode code, const std::string& on, const std::string& what) {
    return {.code = code, .on = on, .what = what};
}
Problem so() {
    return problem_of(ProblemCode::log_stuck, "", "it is so");
}
Problem in_doubt() {
    return problem_of(ProblemCode::time_in_doubt, "", "the time is in doubt");
}
Problem dead(const std::string& sensor) {
    return problem_of(ProblemCode::sensor_not_ranging, sensor, "dead");
}
Problem closed_camera(const std::string& why) {
    return {
        .code = ProblemCode::camera_closed, .on = "camera", .what = why, .detail = why, .subject = "camera"};
}
Problem lost_node(const std::string& node) {
    return {.code = ProblemCode::node_unusable, .on = node, .what = "lost", .subject = node};
}

class ProblemLogTest : public testing::Test {
  protected:
    ProblemLogTest() : before_(spdlog::default_logger()) {
        auto logger =
            std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_));
        logger->set_pattern("%l %v");
        spdlog::set_default_logger(logger);
    }
    ~ProblemLogTest() override { spdlog::set_default_logger(before_); }
    /// What is logged if there are these `after` the ones before.
    std::string reported(std::vector<Problem> problems, Nanoseconds after = ProblemLog::kOver) {
        text_.str({});
        now_ = now_ + after;
        log_.update(std::move(problems), now_, is_settling_);
        return text_.str();
    }

    std::shared_ptr<spdlog::logger> before_;
    std::ostringstream text_;
    ProblemLog log_;
    HostTime now_;
    bool is_settling_ = false;
};

TEST_F(ProblemLogTest, tells_each_when_it_comes_and_when_it_goes) {
    EXPECT_EQ(reported({so()}), "warning it is so\n");
    EXPECT_EQ(reported({so()}), "");
    EXPECT_EQ(reported({}), "info over: it is so\n");
    EXPECT_EQ(reported({}), "");
}

TEST_F(ProblemLogTest, takes_a_number_that_grows_for_the_same) {
    EXPECT_NE(reported({problem_of(ProblemCode::kernel_dropped, "", "3 frames lost")}), "");
    EXPECT_EQ(reported({problem_of(ProblemCode::kernel_dropped, "", "14 frames lost")}), "");
    EXPECT_EQ(reported({}), "info over: 14 frames lost\n");
}

TEST_F(ProblemLogTest, tells_those_apart_whose_names_differ_in_a_digit) {
    EXPECT_NE(reported({dead("node 1 sensor 3")}), "");
    EXPECT_EQ(reported({dead("node 1 sensor 3"), dead("node 1 sensor 13")}),
              "warning node 1 sensor 13: dead\n");
    EXPECT_EQ(reported({dead("node 2 sensor 3")}),
              "warning node 2 sensor 3: dead\ninfo over: node 1 sensor 3: dead\n"
              "info over: node 1 sensor 13: dead\n");
    const Problem can0 = problem_of(ProblemCode::can_link, "can0", "down");
    const Problem can1 = problem_of(ProblemCode::can_link, "can1", "down");
    EXPECT_EQ(reported({can0}), "warning can0: down\ninfo over: node 2 sensor 3: dead\n");
    EXPECT_EQ(reported({can1}), "warning can1: down\ninfo over: can0: down\n");
}

TEST_F(ProblemLogTest, distinguishes_problems_on_one_part_by_code_and_detail) {
    const Problem stamps{
        .code = ProblemCode::time_in_doubt, .what = "the stamps went back", .detail = "stamps"};
    const Problem exchanges{
        .code = ProblemCode::time_in_doubt, .what = "two exchanges differ", .detail = "exchanges"};
    Problem back = stamps;
    back.code = ProblemCode::time_back;
    back.what = "the time went back";
    EXPECT_FALSE(stamps.is_same(exchanges));
    EXPECT_FALSE(stamps.is_same(back));
    EXPECT_EQ(reported({stamps}), "warning the stamps went back\n");
    EXPECT_EQ(reported({stamps, exchanges}), "warning two exchanges differ\n");
    EXPECT_EQ(reported({exchanges, back}), "warning the time went back\ninfo over: the stamps went back\n");
}

TEST_F(ProblemLogTest, writes_the_part_its_condition_and_the_remedy) {
    EXPECT_EQ(reported({{.code = ProblemCode::camera_silent,
                         .on = "camera",
                         .what = "no frame",
                         .remedy = "plug it in"}}),
              "warning camera: no frame: plug it in\n");
    EXPECT_EQ(
        reported({{.code = ProblemCode::joints_missing, .what = "no joint states", .remedy = "send them"}}),
        "warning no joint states: send them\ninfo over: camera: no frame: plug it in\n");
}

TEST_F(ProblemLogTest, tells_one_that_comes_and_goes_once) {
    const Problem silent = problem_of(ProblemCode::camera_silent, "", "no frame");
    std::string all;
    constexpr Nanoseconds kTurn{50'000'000};
    for (int turn = 0; turn < 280; ++turn)  // 14 s
        all += reported(turn % 4 < 2 ? std::vector<Problem>{silent} : std::vector<Problem>{}, kTurn);
    EXPECT_EQ(all, "warning no frame\n");
    EXPECT_EQ(reported({}, ProblemLog::kOver - 3 * kTurn), "");
    EXPECT_EQ(reported({}, 3 * kTurn), "info over: no frame\n");
    EXPECT_EQ(reported({silent}, kTurn), "warning no frame\n");
}

/// A clock in doubt for 2 s of each 4.5 s.
std::vector<Problem> doubtful(Nanoseconds at) {
    const bool is_there = at % Nanoseconds{4'500'000'000} < Nanoseconds{2'000'000'000};
    return is_there ? std::vector<Problem>{in_doubt()} : std::vector<Problem>{};
}

TEST_F(ProblemLogTest, tells_one_that_flaps_for_17_minutes_in_few_lines_and_how_often_it_did) {
    constexpr Nanoseconds kTurn{50'000'000};
    std::string all;
    for (Nanoseconds at{0}; at < std::chrono::minutes(17); at += kTurn) all += reported(doubtful(at), kTurn);
    EXPECT_EQ(all,
              "warning the time is in doubt\ninfo over: the time is in doubt\n"
              "warning the time is in doubt\ninfo over: the time is in doubt\n"
              "warning the time is in doubt\ninfo over: the time is in doubt\n"
              "warning the time is in doubt\n")
        << "from the fourth time on it must be away for 4 s";
    std::string end;
    for (Nanoseconds at{0}; at < std::chrono::seconds(600); at += kTurn) end += reported({}, kTurn);
    EXPECT_EQ(end, "info over: the time is in doubt (it came and went 227 times)\n");
    EXPECT_EQ(reported({in_doubt()}, kTurn), "warning the time is in doubt\n");
    EXPECT_EQ(reported({}, ProblemLog::kOver), "info over: the time is in doubt\n") << "that was long ago";
}

/// Away each time for as long as it must be: the worst that one can do.
TEST_F(ProblemLogTest, tells_one_that_flaps_as_the_log_would_have_it_less_and_less_often) {
    int lines = 0;
    const HostTime begun = now_;
    while (now_ - begun < std::chrono::hours(24)) {
        const std::string text =
            reported(lines % 2 == 0 ? std::vector<Problem>{in_doubt()} : std::vector<Problem>{},
                     Nanoseconds{500'000'000});
        lines += static_cast<int>(std::ranges::count(text, '\n'));
    }
    EXPECT_LE(lines, 2 * 24 * 12 + 30) << "one turn in five minutes";
    EXPECT_GE(lines, 2 * 24 * 11);
}

TEST_F(ProblemLogTest, reports_no_end_of_a_problem_that_another_of_its_subject_replaced) {
    EXPECT_EQ(reported({closed_camera("unplugged")}), "warning camera: unplugged\n");
    EXPECT_EQ(reported({closed_camera("no such file")}), "warning camera: no such file\n");
    EXPECT_EQ(reported({closed_camera("no such file")}), "");
    EXPECT_EQ(reported({lost_node("node 1")}), "warning node 1: lost\ninfo over: camera: no such file\n");
}

TEST_F(ProblemLogTest, takes_none_for_over_that_another_hides_and_tells_it_once) {
    const Problem lies{.code = ProblemCode::sensor_contradicts_camera,
                       .on = "sensor 3",
                       .what = "lies",
                       .hidden_by = "node 1"};
    const Problem lost = lost_node("node 1");
    const Problem other = lost_node("node 2");
    EXPECT_EQ(reported({lies}), "warning sensor 3: lies\n");
    EXPECT_EQ(reported({lost}), "warning node 1: lost\n");
    EXPECT_EQ(reported({lost}), "");
    EXPECT_EQ(reported({lies}), "info over: node 1: lost\n") << "it lies as before";
    EXPECT_EQ(reported({lost}), "warning node 1: lost\n");
    EXPECT_EQ(reported({}, ProblemLog::kOver - Nanoseconds{1}), "");
    EXPECT_EQ(reported({}, Nanoseconds{1}), "info over: sensor 3: lies\ninfo over: node 1: lost\n");
    EXPECT_EQ(reported({lies}), "warning sensor 3: lies\n");
    EXPECT_EQ(reported({other}), "warning node 2: lost\ninfo over: sensor 3: lies\n") << "another's";
}

TEST_F(ProblemLogTest, takes_none_for_over_while_they_cannot_be_judged) {
    EXPECT_EQ(reported({so()}), "warning it is so\n");
    is_settling_ = true;
    EXPECT_EQ(reported({}), "");
    EXPECT_EQ(reported({}), "");
    is_settling_ = false;
    EXPECT_EQ(reported({so()}), "");
    EXPECT_EQ(reported({}), "info over: it is so\n");
}

}  // namespace
}  // namespace octoskin
