// Questions that come while the map goes on. The oracle is a search in a copy of the map as it was when the
// question's turn came.
#include "host/apps/daemon/query_server.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "host/apps/query/query_answer.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

using Json = nlohmann::ordered_json;

class QueryServerTest : public testing::Test {
  protected:
    static constexpr HostTime kNow{1'000'000'000'000};
    static constexpr Nanoseconds kSecond{1'000'000'000};

    static FusedMap free_about_base(const MapConfig& config) {
        FusedMap map(config);
        for (int i = 0; i < 8; ++i) {
            const auto along = [i](int axis) {
                return static_cast<std::uint16_t>(kOriginKey - ((i >> axis & 1) != 0 ? 32 : 0));
            };
            EXPECT_TRUE(map.set_cube({{along(0), along(1), along(2)}, 5}, -1.0F));
        }
        return map;
    }
    /// The same, just seen.
    [[nodiscard]] FusedMap confirmed_about_base() const {
        FusedMap map = free_about_base(scene_.mapping.map);
        map.advance_time(kNow);
        std::vector<VoxelUpdate> seen;
        map.for_each_known([&](VoxelKey key, float) { seen.push_back({key, -0.1F}); });
        feed(map, seen, SensorKind::camera);
        return map;
    }
    void SetUp() override { pipeline_.begin_with(free_about_base(scene_.mapping.map)); }

    [[nodiscard]] const FusedMap& map() const { return pipeline_.map(); }
    void mark(std::mt19937& random) {
        std::uniform_real_distribution<double> along(-0.6, 0.6);
        FusedMap next = map().copy();
        for (int i = 0; i < 5; ++i) {
            const Eigen::Vector3d point(along(random), along(random), along(random));
            EXPECT_TRUE(next.set_cube({*next.key_of(point), 0}, random() % 5 == 0 ? 2.0F : -1.0F));
        }
        pipeline_.begin_with(std::move(next));
    }
    static constexpr uid_t kUser = 1000;
    void ask(const QueryRequest& request, std::uint64_t ticket) { ask(desk_, request, ticket); }
    static void ask(QueryServer& desk, const QueryRequest& request, std::uint64_t ticket,
                    uid_t user = kUser) {
        ASSERT_TRUE(desk.take(to_line(request), ticket, user));
    }
    /// The state that the daemon answers of where the arm has free space about it, while the time is in
    /// doubt.
    std::string state_in_doubt(HostTime reckoned) {
        ask(path({{0.0}}), 1);
        return answers(desk_, 1, {std::nullopt, reckoned, kWall})[1].at("state");
    }
    std::map<std::uint64_t, Json> answers(std::size_t count) { return answers(desk_, count); }
    static constexpr WallTime kWall{1'750'000'000'250'000'000};
    std::map<std::uint64_t, Json> answers(QueryServer& desk, std::size_t count) {
        return answers(desk, count, {kNow, kNow, kWall});
    }
    /// All of them; fewer if they take too long.
    std::map<std::uint64_t, Json> answers(QueryServer& desk, std::size_t count, const QueryServer::Now& now) {
        std::map<std::uint64_t, Json> answers;
        constexpr int kPatience_ms = 20'000;
        while (answers.size() < count) {
            pollfd readable{desk.descriptor(), POLLIN, 0};
            if (::poll(&readable, 1, kPatience_ms) != 1) return answers;
            for (const auto& [ticket, line] : desk.serve(pipeline_, now)) answers[ticket] = Json::parse(line);
        }
        return answers;
    }
    static QueryRequest path(std::vector<std::vector<double>> configurations) {
        QueryRequest request;
        request.path = std::move(configurations);
        return request;
    }

    static constexpr std::uint32_t kStaleAfter_s = 60;
    static Scene scene_that_ages() {
        Scene scene = good_scene();
        scene.mapping.map.age.stale_after_s = kStaleAfter_s;
        return scene;
    }
    Scene scene_ = scene_that_ages();
    Pipeline pipeline_ = make_pipeline(scene_);
    HostSetup setup_{scene_.rig, one_joint_robot(), {}};
    QueryServer desk_{setup_};
};

TEST_F(QueryServerTest, keeps_a_field_for_long_paths_and_none_for_a_posture) {
    ask(path({{0.0}}), 1);
    EXPECT_EQ(answers(1)[1].at("distances"), "search");
    ask(path({{0.0}, {3.0}}), 2);
    EXPECT_EQ(answers(1)[2].at("distances"), "field");
    ask(path({{1.0}}), 3);
    EXPECT_EQ(answers(1)[3].at("distances"), "field") << "it is there, and nothing has changed";
    QueryRequest touched = path({{0.0}, {3.0}});
    touched.reach_m = 0.0;
    ask(touched, 4);
    EXPECT_TRUE(answers(1)[4].at("distances").is_null());
}

TEST_F(QueryServerTest, a_saved_map_is_stale_though_nodes_speak_and_nobody_knows_the_time) {
    EXPECT_EQ(state_in_doubt(kNow), "stale");
    EXPECT_EQ(state_in_doubt(kNow + 3 * kSecond), "stale");
}

TEST_F(QueryServerTest, a_map_grows_older_while_the_time_is_in_doubt) {
    pipeline_.begin_with(confirmed_about_base());
    constexpr Nanoseconds kStaleAfter = kStaleAfter_s * kSecond;
    EXPECT_EQ(state_in_doubt(kNow), "free");
    EXPECT_EQ(state_in_doubt(kNow + kStaleAfter - 2 * kSecond), "free");
    EXPECT_EQ(state_in_doubt(kNow + kStaleAfter + 2 * kSecond), "stale");
}

TEST_F(QueryServerTest, lets_go_of_the_field_when_nobody_asks) {
    QueryServer hasty(setup_, {}, std::chrono::milliseconds(1));
    ask(hasty, path({{0.0}, {3.0}}), 1);
    EXPECT_EQ(answers(hasty, 1)[1].at("distances"), "field");
    std::string of_a_posture = "field";
    for (std::uint64_t ticket = 2; ticket < 200 && of_a_posture == "field"; ++ticket) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        ask(hasty, path({{1.0}}), ticket);
        of_a_posture = answers(hasty, 1)[ticket].at("distances");
    }
    EXPECT_EQ(of_a_posture, "search");
}

/// Seconds of work: nobody waits for the end of it.
QueryRequest long_one() {
    QueryRequest request;
    request.step = 0.005;
    for (int i = 0; i < 80; ++i) request.path.push_back({i % 2 == 0 ? -1.5 : 1.5});
    request.reach_m = 5.0;
    return request;
}

TEST_F(QueryServerTest, seeks_no_answer_that_nobody_waits_for) {
    constexpr std::uint64_t kAsked = 40;
    for (std::uint64_t ticket = 1; ticket <= kAsked; ++ticket) ask(long_one(), ticket);
    ask(path({{0.0}}), kAsked + 1);
    // The first is at work: those that wait are forgotten before another could begin.
    for (std::uint64_t ticket = kAsked; ticket > 0; --ticket) desk_.forget(ticket);
    std::map<std::uint64_t, Json> reported;
    while (!reported.contains(kAsked + 1)) {
        auto more = answers(1);
        ASSERT_FALSE(more.empty()) << "it works on for those that have gone";
        reported.merge(more);
    }
    EXPECT_TRUE(reported[kAsked + 1].at("ok").get<bool>());
    EXPECT_LE(reported.size(), 2U) << "one was at work, the others were waiting";
    reported.erase(kAsked + 1);
    for (const auto& [ticket, answer] : reported)
        EXPECT_FALSE(answer.at("ok").get<bool>()) << ticket << " was worked out to its end";
}

TEST_F(QueryServerTest, answers_all_that_are_not_forgotten) {
    for (std::uint64_t ticket = 1; ticket <= 40; ++ticket) ask(path({{0.0}}), ticket);
    desk_.forget(41);
    EXPECT_EQ(answers(40).size(), 40U);
}

TEST_F(QueryServerTest, answers_users_by_turns) {
    // The first waits for its map meanwhile.
    for (std::uint64_t ticket = 11; ticket <= 14; ++ticket) ask(desk_, path({{0.0}}), ticket, kUser);
    for (std::uint64_t ticket = 21; ticket <= 22; ++ticket) ask(desk_, path({{0.0}}), ticket, kUser + 1);
    ask(desk_, path({{0.0}}), 31, kUser + 2);
    std::vector<std::uint64_t> order;
    while (order.size() < 7) {
        pollfd readable{desk_.descriptor(), POLLIN, 0};
        ASSERT_EQ(::poll(&readable, 1, 20'000), 1);
        for (const auto& [ticket, line] : desk_.serve(pipeline_, {kNow, kNow, kWall})) {
            EXPECT_TRUE(Json::parse(line).at("ok").get<bool>());
            order.push_back(ticket);
            if (ticket == 11) ask(desk_, path({{0.0}}), 15, kUser);
        }
    }
    EXPECT_EQ(order, (std::vector<std::uint64_t>{11, 21, 31, 12, 22, 13, 14}));
    EXPECT_EQ(answers(1).count(15), 1U);
}

TEST_F(QueryServerTest, answers_the_second_question_of_one_user_though_others_ask_again_and_again) {
    ask(desk_, path({{0.0}}), 11, kUser);
    ask(desk_, path({{0.0}}), 12, kUser);
    ask(desk_, path({{0.0}}), 21, kUser + 1);
    ask(desk_, path({{0.0}}), 31, kUser + 2);
    std::vector<std::uint64_t> order;
    while (order.size() < 6) {
        pollfd readable{desk_.descriptor(), POLLIN, 0};
        ASSERT_EQ(::poll(&readable, 1, 20'000), 1);
        for (const auto& [ticket, line] : desk_.serve(pipeline_, {kNow, kNow, kWall})) {
            order.push_back(ticket);
            if (ticket == 21) ask(desk_, path({{0.0}}), 22, kUser + 1);
            if (ticket == 31) ask(desk_, path({{0.0}}), 32, kUser + 2);
        }
    }
    EXPECT_EQ(order, (std::vector<std::uint64_t>{11, 21, 31, 12, 22, 32}));
}

TEST_F(QueryServerTest, ends_a_question_that_takes_too_long) {
    QueryServer hasty(setup_, {}, QueryServer::kFieldIdleMax, std::chrono::milliseconds(1));
    ask(hasty, long_one(), 1);
    const Json path_answer = answers(hasty, 1)[1];
    EXPECT_FALSE(path_answer.at("ok").get<bool>());
    EXPECT_EQ(path_answer.at("exit"), static_cast<int>(ExitCode::unavailable));
    QueryRequest pockets;
    pockets.kind = QueryKind::pockets;
    pockets.path = {{0.0}};
    pockets.radius_m = 4.0;
    ask(hasty, pockets, 2);
    const Json pockets_answer = answers(hasty, 1)[2];
    EXPECT_FALSE(pockets_answer.at("ok").get<bool>());
    EXPECT_EQ(pockets_answer.at("exit"), static_cast<int>(ExitCode::unavailable));
}

TEST_F(QueryServerTest, states_when_the_map_was_as_it_answers) {
    ask(path({{0.0}}), 1);
    EXPECT_EQ(answers(1)[1].at("map_time_s").get<double>(), 1'750'000'000.25);
}

TEST_F(QueryServerTest, a_question_that_waits_is_put_to_the_map_of_its_own_turn) {
    ask(path({{0.0}}), 1);
    ask(path({{0.0}}), 2);
    pollfd readable{desk_.descriptor(), POLLIN, 0};
    ASSERT_EQ(::poll(&readable, 1, 20'000), 1);
    EXPECT_TRUE(desk_.serve(pipeline_, {kNow, kNow, kWall}).empty())
        << "the first has its map, and no answer";
    pipeline_.begin_with(confirmed_about_base());
    auto reported = answers(2);
    EXPECT_EQ(reported[1].at("state"), "stale");
    EXPECT_EQ(reported[2].at("state"), "free");
}

TEST_F(QueryServerTest, answers_of_the_map_as_it_was_when_the_turn_came) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> turn(-1.5, 3.0);
    std::map<std::uint64_t, Json> wanted;
    std::size_t by_field = 0;
    for (std::uint64_t round = 0; round < 6; ++round) {
        mark(random);
        for (std::uint64_t i = 0; i < 8; ++i) {
            const std::uint64_t ticket = 10 * round + i;
            const QueryRequest request = path({{turn(random)}, {turn(random)}, {turn(random)}});
            ask(request, ticket);
            FusedMap then = map().copy();
            then.advance_time(kNow);
            wanted[ticket] = answer_query(request, {&setup_.rig, &setup_.robot, std::move(then), {}});
        }
        for (auto& [ticket, answer] : answers(8)) {
            by_field += answer.at("distances") == "field" ? 1U : 0U;
            for (Json* json : {&answer, &wanted[ticket]}) {
                json->erase("took_us");
                json->erase("map_time_s");
                json->erase("distances");
            }
            EXPECT_EQ(answer, wanted[ticket]) << ticket;
            wanted.erase(ticket);
        }
    }
    EXPECT_TRUE(wanted.empty()) << wanted.size() << " were not answered";
    EXPECT_GT(by_field, 24U);
}

}  // namespace
}  // namespace octoskin::test
