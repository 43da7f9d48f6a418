// What `octoskin query` asks a daemon, while its map goes on.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/apps/query/query_request.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"
#include "tests/system/said.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

class QueryTest : public DaemonTest {
  protected:
    [[nodiscard]] std::string socket() const { return (folder_ / "control").string(); }
    [[nodiscard]] Json ask(const QueryRequest& request) const {
        // Four may wait for each other, with ten seconds of processor time each, under a sanitizer.
        const auto answer = ask_daemon(socket(), to_line(request), 90s);
        EXPECT_TRUE(answer) << answer.error().message();
        return answer ? Json::parse(*answer) : Json();
    }
    /// A saved map in which all about the arm is free.
    void save_free_map() const {
        std::filesystem::create_directories(folder_ / "maps");
        FusedMap map{MapConfig{.resolution_m = 0.04}};
        constexpr std::array<std::uint16_t, 2> kSides{32704, 32768};
        for (const auto x : kSides)
            for (const auto y : kSides)
                for (const auto z : kSides) ASSERT_TRUE(map.set_cube({{x, y, z}, 6}, -2.0F));
        ASSERT_TRUE(save_map(map, folder_ / "maps" / "fused.ot"));
    }
    /// Upright, and out of the way of all that ranges.
    [[nodiscard]] std::string upright() const {
        return "query --joints 0,0,0,-0.1,0,1.6,0 --socket " + socket();
    }
    void start_and_range() {
        start();
        ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    }
};

TEST_F(QueryTest, is_answered_for_the_arm_as_it_stands) {
    start_and_range();
    const Json answer = ask({});
    ASSERT_TRUE(answer.at("ok").get<bool>()) << answer;
    EXPECT_NE(answer.at("state"), "free") << "without a camera nobody has seen the space of the shoulder";
    EXPECT_EQ(answer.at("legs").size(), 1U);
    EXPECT_EQ(answer.at("legs").at(0).at("not_free_m"), 0.0);

    const Said said = octoskin("query --joints -0.1,-0.785,0,-2.356,0,1.571,0.785 --socket " + socket());
    EXPECT_TRUE(said.exit_code == 1 || said.exit_code == 2) << said.output;
    EXPECT_NE(said.output.find("panda_link"), std::string::npos) << said.output;
}

TEST_F(QueryTest, about_the_unknown_lists_pockets) {
    start_and_range();
    const Said said = octoskin("query --unknown --tries 300 --json --socket " + socket());
    ASSERT_EQ(said.exit_code, 0) << said.output;
    const Json answer = Json::parse(said.output);
    EXPECT_GT(answer.at("unknown_m3").get<double>(), 0.1);
    ASSERT_GE(answer.at("pockets").size(), 1U);
    EXPECT_GT(answer.at("pockets").at(0).at("border_voxels").get<int>(), 0);
}

TEST_F(QueryTest, is_refused_by_name_of_what_is_wrong) {
    start_and_range();
    const Said two = octoskin("query --joints 0,0 --socket " + socket());
    EXPECT_EQ(two.exit_code, 64) << two.output;
    EXPECT_NE(two.output.find("configuration 1: "), std::string::npos) << two.output;
    EXPECT_NE(two.output.find("7 joints: panda_joint1, "), std::string::npos) << two.output;
    EXPECT_NE(two.output.find("found 2 positions"), std::string::npos) << two.output;
    const Said beyond = octoskin("query --joints 9,0,0,-1,0,1,0 --socket " + socket());
    EXPECT_EQ(beyond.exit_code, 64) << beyond.output;
    EXPECT_NE(beyond.output.find("panda_joint1: "), std::string::npos) << beyond.output;
    EXPECT_NE(beyond.output.find(" to 2.8973, found 9"), std::string::npos) << beyond.output;
    const auto unheard = ask_daemon(socket(), "where are you", 30s);
    ASSERT_TRUE(unheard);
    const Json refusal = Json::parse(*unheard);
    EXPECT_EQ(refusal.at("ok"), false) << *unheard;
    EXPECT_EQ(refusal.at("exit"), 64) << *unheard;
    EXPECT_EQ(refusal.at("error").at("code"), "bad_argument") << *unheard;
}

/// Each of these takes the thread a second or so; what the loop answers itself is not behind them.
TEST_F(QueryTest, holds_nothing_else_up) {
    start_and_range();
    QueryRequest request;
    request.step = 0.01;
    for (int i = 0; i < 30; ++i)
        request.path.push_back({i % 2 == 0 ? 1.0 : -1.0, -0.785, 0, -2.356, 0, 1.571, 0});
    std::vector<std::thread> clients;
    std::vector<Json> answers(4);
    for (Json& answer : answers) clients.emplace_back([&] { answer = ask(request); });
    std::this_thread::sleep_for(50ms);  // they are asking by now
    const auto begun = std::chrono::steady_clock::now();
    const Json status = daemon_->status();
    const auto took = std::chrono::steady_clock::now() - begun;
    for (std::thread& client : clients) client.join();
    ASSERT_TRUE(status.is_object());
    double all_us = 0.0;
    for (const Json& answer : answers) {
        EXPECT_TRUE(answer.at("ok").get<bool>()) << answer;
        all_us += answer.at("took_us").get<double>();
    }
    RecordProperty("queries_took_ms", std::to_string(all_us * 1e-3));
    RecordProperty("status_took_ms", std::to_string(std::chrono::duration<double, std::milli>(took).count()));
    EXPECT_LT(std::chrono::duration<double>(took).count(), 0.5 * all_us * 1e-6);
    EXPECT_TRUE(daemon_->wait_until([](const Json& now) { return !has_problem(now, "late"); }, 5s));
}

/// Of too many clients the daemon drops the first, and what they asked with them.
TEST_F(QueryTest, is_not_kept_waiting_by_who_has_gone) {
    start_and_range();
    QueryRequest slow;
    slow.kind = QueryKind::pockets;
    slow.views_tried = kViewsTriedMax / 8;  // a sanitizer takes less than the ten seconds for it, too
    const std::string line = to_line(slow) + "\n";
    std::vector<int> clients;
    const auto begun = std::chrono::steady_clock::now();
    const Json one = ask(slow);
    const auto took = std::chrono::steady_clock::now() - begun;
    EXPECT_TRUE(one.at("ok").get<bool>()) << one;
    for (int i = 0; i < 48; ++i) {
        const auto client = connect_unix_socket(socket(), SOCK_STREAM);
        ASSERT_TRUE(client) << i;
        clients.push_back(*client);
        ASSERT_EQ(::send(*client, line.data(), line.size(), MSG_NOSIGNAL), static_cast<ssize_t>(line.size()));
        std::this_thread::sleep_for(10ms);
    }
    for (const int client : clients) ::close(client);
    const auto asked = std::chrono::steady_clock::now();
    const Json answer = ask({});
    EXPECT_TRUE(answer.at("ok").get<bool>()) << answer;
    RecordProperty("one_took_ms", std::to_string(std::chrono::duration<double, std::milli>(took).count()));
    EXPECT_LT(std::chrono::steady_clock::now() - asked, 4 * took + 500ms) << "sixteen waited before it";
    std::vector<int> waiting;
    for (int i = 0; i < 4; ++i) {
        waiting.push_back(*connect_unix_socket(socket(), SOCK_STREAM));
        ASSERT_GT(::send(waiting.back(), line.data(), line.size(), MSG_NOSIGNAL), 0);
    }
    std::this_thread::sleep_for(50ms);
    daemon_->signal(SIGTERM);  // it is searching for views, which would take it seconds more
    EXPECT_EQ(daemon_->wait(10s), std::optional<int>(0)) << daemon_->log();
    for (const int client : waiting) ::close(client);
}

/// What nobody has seen since the daemon began, however free it was before.
TEST_F(QueryTest, tells_a_script_and_a_person_that_what_was_free_is_stale) {
    save_free_map();
    const auto mapping =
        folder_.write("mapping.yaml", "base: fast\nage: {stale_after_s: 1, unknown_after_s: 0}\n");
    start({"--no-camera", "--configuration", mapping.string()});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const std::string asked = upright();
    const Said stale = octoskin(asked);
    EXPECT_EQ(stale.exit_code, 2) << stale.output;
    EXPECT_EQ(stale.output.rfind("stale: panda_", 0), 0U) << stale.output;
    EXPECT_NE(stale.output.find("weakest evidence: "), std::string::npos) << stale.output;
    EXPECT_NE(octoskin(asked + " --json").output.find("\"state\": \"stale\""), std::string::npos);
    (void)folder_.write("mapping.yaml", "base: fast\nage: {stale_after_s: 0, unknown_after_s: 0}\n");
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return now["reloads"]["count"] == 1; }, 10s))
        << daemon_->status();
    const Said free = octoskin(asked);
    EXPECT_EQ(free.exit_code, 0) << "nothing is ever stale: " << free.output;
}

TEST_F(QueryTest, tells_that_a_saved_map_is_stale_while_nodes_speak_and_nobody_tells_the_time) {
    save_free_map();
    start({"--no-camera", "--listen-only"});
    const auto is_heard = [](const Json& now) { return now["nodes"][0]["verdict"] == "usable"; };
    ASSERT_TRUE(daemon_->wait_until(is_heard, 15s)) << daemon_->status()["nodes"].dump(1);
    ASSERT_FALSE(daemon_->status()["clock"]["known"].get<bool>());
    const Said stale = octoskin(upright());
    EXPECT_EQ(stale.exit_code, 2) << stale.output;
    EXPECT_EQ(stale.output.rfind("stale: panda_", 0), 0U) << stale.output;
}

TEST_F(QueryTest, says_that_nobody_knows_how_the_arm_stands) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    bus_->silence(3, true);  // the joints
    std::this_thread::sleep_for(1500ms);
    const Said said = octoskin("query --socket " + socket());
    EXPECT_EQ(said.exit_code, 69) << said.output;
    EXPECT_NE(said.output.find("the arm's posture is unknown"), std::string::npos) << said.output;
}

}  // namespace
}  // namespace octoskin::test
