// What the daemon records gives its own map again, byte for byte.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <functional>
#include <memory>
#include <regex>
#include <sstream>
#include <thread>
#include <vector>

#include "host/apps/daemon/daemon_client.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"
#include "tests/system/said.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using testing_support::ScratchFolder;

/// Without warnings, which would spoil JSON.
Said octoskin_json(const std::string& arguments) {
    return run(typed(arguments), "2> /dev/null");
}

/// Empty while nothing was recorded: there is a null then.
std::string state_of_recording(const Json& status) {
    return status.value(Json::json_pointer("/recording/state"), "");
}

class DaemonRecording : public DaemonTest {
  protected:
    std::string out() const { return (folder_ / "recording").string(); }
    Said record(const std::string& arguments) const {
        return octoskin("record " + arguments + " --socket " + (folder_ / "control").string());
    }
    Json ask(const std::string& line) const {
        return Json::parse(ask_daemon(folder_ / "control", line).value());
    }
    /// Expects an answer with this exit code, whose error has these parts.
    void expect_refusal(const std::string& line, int exit, const Json& parts) const {
        const Json answer = ask(line);
        EXPECT_EQ(answer["ok"], false) << answer;
        EXPECT_EQ(answer["exit"], exit) << answer;
        for (const auto& [key, value] : parts.items()) EXPECT_EQ(answer["error"][key], value) << answer;
    }
    void expect_only_its_user_may_write() const {
        using std::filesystem::perms;
        constexpr perms kOthers = perms::group_write | perms::others_write;
        for (const auto& top : {std::filesystem::path(out()), folder_ / "maps"}) {
            EXPECT_EQ(std::filesystem::status(top).permissions() & kOthers, perms::none) << top;
            for (const auto& entry : std::filesystem::directory_iterator(top))
                EXPECT_EQ(entry.status().permissions() & kOthers, perms::none) << entry.path();
        }
    }
    /// That a replay gives the map that the daemon had at the end of it.
    void expect_own_map(const std::string& configuration = "") const {
        const Said replay = octoskin("replay " + out() + " --fused-only " + configuration);
        EXPECT_EQ(replay.exit_code, 0) << replay.output;
        EXPECT_EQ(replay.output.find("CAN frames"), std::string::npos) << "it plays commits" << replay.output;
        EXPECT_NE(replay.output.find("identical to the daemon's, byte for byte"), std::string::npos)
            << replay.output;
        EXPECT_TRUE(ScratchFolder::read(out() + "/maps/fused.ot") == ScratchFolder::read(out() + "/last.ot"));
    }
};

TEST_F(DaemonRecording, begun_in_mid_run_gives_the_daemons_own_map_byte_for_byte) {
    const auto wall = record_wall(folder_, 24);
    start({"--camera", wall.string()});
    ASSERT_TRUE(daemon_->wait_until(
        [](const Json& status) {
            return is_ranging(status) && status["inputs"]["depth frames"]["used"].get<int>() >= 3;
        },
        20s))
        << daemon_->log();
    const Said recorded = record(out() + " --seconds 6");
    ASSERT_EQ(recorded.exit_code, 0) << recorded.output << daemon_->log();
    const Json recording = daemon_->status()["recording"];
    EXPECT_EQ(recording["state"], "ended");
    EXPECT_TRUE(recording["is_complete"].get<bool>()) << recording.dump();
    EXPECT_GT(recording["depth_frames"].get<int>(), 5) << recording.dump();
    EXPECT_GT(recording["can_frames"].get<int>(), 1'000) << recording.dump();
    EXPECT_FALSE(ScratchFolder::read(out() + "/first.ot") == ScratchFolder::read(out() + "/last.ot"));
    std::printf("%s", recorded.output.c_str());
    expect_own_map();

    // What explains a voxel starts from the map that was there: it refuses if the sum is not the map's. The
    // first point is 1.5 m before the camera in the wall's columns, which every frame sees through; what the
    // sensors changed meanwhile depends on where the arm was.
    const std::string explain = "explain --json --recording " + out() + " ";
    int went_on = 0;
    for (const char* point :
         {"1.4 -1 1.04", "1.5 0 0.5", "1 0 0.5", "0.8 0.3 0.3", "0.5 0.5 0.5", "0.3 0.2 0.8"}) {
        const Said explained = octoskin_json(explain + point);
        ASSERT_EQ(explained.exit_code, 0) << explained.output;
        const Json json = Json::parse(explained.output);
        went_on += !json["log_odds_at_begin"].is_null() && !json["contributions"].empty() ? 1 : 0;
    }
    EXPECT_GT(went_on, 0) << "no voxel was known at the begin and changed afterwards";
    // Both orders count from the recording's begin, and the daemon had joint samples of before that.
    const std::string seen_through = explain + "1.4 -1 1.04";
    const Json ordered = Json::parse(octoskin_json(seen_through).output);
    const Json by_time = Json::parse(octoskin_json(seen_through + " --by-capture-time").output);
    ASSERT_FALSE(ordered["contributions"].empty());
    // By capture time the clocks are learnt in the recording itself: a busy machine takes seconds for that.
    ASSERT_FALSE(by_time["contributions"].empty())
        << by_time.dump(1)
        << octoskin("replay " + out() + " --fused-only --by-capture-time --out " + out() + "-again").output;
    const double last_s = ordered["contributions"].back()["time_s"].get<double>();
    EXPECT_NEAR(last_s, by_time["contributions"].back()["time_s"].get<double>(), 0.11) << "a frame's period";
    EXPECT_LT(last_s, 6.1);
    EXPECT_GT(last_s, 5.0);

    // The same again in the order of capture times: another map, and the same one every time.
    const auto in_order = ScratchFolder::read(out() + "/maps/fused.ot");
    const std::string plain = "replay " + out() + " --fused-only --by-capture-time";
    EXPECT_EQ(octoskin(plain).exit_code, 0) << octoskin(plain).output;
    const auto first = ScratchFolder::read(out() + "/maps/fused.ot");
    EXPECT_EQ(octoskin(plain).exit_code, 0);
    EXPECT_TRUE(ScratchFolder::read(out() + "/maps/fused.ot") == first);
    EXPECT_FALSE(first == in_order);

    // With a rig that places the base elsewhere what the daemon had mapped before would be of another world.
    const auto known_with = [this](const std::string& rig_keys) {
        const auto rig = folder_.write("given.yaml", "extends: " + out() + "/rig.yaml\n" + rig_keys);
        const std::string maps = (folder_ / "maps-given").string();
        const Said said =
            octoskin("replay " + out() + " --fused-only --rig " + rig.string() + " --out " + maps);
        EXPECT_EQ(said.exit_code, 0) << said.output;
        const auto map = load_map(maps + "/fused.ot");
        return map ? map->map.known_voxels() : 0;
    };
    const std::size_t named_otherwise = known_with("name: other\n");
    EXPECT_GE(named_otherwise, load_map(out() + "/first.ot")->map.known_voxels());
    EXPECT_LT(known_with("T_map_base: {xyz_m: [0.001, 0, 0], rpy_deg: [0, 0, 0]}\n"), named_otherwise);
}

/// Some 490 bricks of 2064 bytes and their nodes are the one MiB: 448 that nothing touches, the rest is soon
/// taken.
TEST_F(DaemonRecording, begun_with_a_full_map_gives_the_daemons_own_map_and_explains_what_had_no_room) {
    FusedMap map{MapConfig{}};
    for (std::uint16_t i = 0; i < 7; ++i)
        ASSERT_TRUE(map.set_cube({.lowest = {static_cast<std::uint16_t>(32 * i), 0, 0}, .height = 5}, 1.0F));
    std::filesystem::create_directory(folder_ / "maps");
    ASSERT_TRUE(save_map(map, folder_ / "maps" / "fused.ot"));
    const auto file = folder_.write("mapping.yaml", "base: robust\nmap: {memory_max_mib: 1}\n");
    const mode_t before = ::umask(0);
    start({"--no-camera", "--configuration", file.string()});
    ::umask(before);
    ASSERT_TRUE(daemon_->wait_until(
        [](const Json& status) { return is_ranging(status) && has_problem(status, "map_full"); }, 15s))
        << daemon_->status()["map"].dump(1) << daemon_->log();
    const Said recorded = record(out() + " --seconds 2");
    ASSERT_EQ(recorded.exit_code, 0) << recorded.output << daemon_->log();
    expect_only_its_user_may_write();
    expect_own_map();
    // A voxel that a map with more room has.
    const auto more = folder_.write("more.yaml", "base: robust\nmap: {memory_max_mib: 100}\n");
    const Said roomy = octoskin("replay " + out() + " --fused-only --configuration " + more.string() +
                                " --out " + (folder_ / "roomy").string());
    ASSERT_EQ(roomy.exit_code, 0) << roomy.output;
    const FusedMap own = std::move(load_map(out() + "/last.ot").value().map);
    std::optional<Eigen::Vector3d> refused;
    load_map(folder_ / "roomy" / "fused.ot").value().map.for_each_known([&](VoxelKey key, float) {
        if (!own.log_odds(key)) refused = own.centre_of(key);
    });
    ASSERT_TRUE(refused);
    const Said explained = octoskin(
        fmt::format("explain --recording {} -- {} {} {}", out(), refused->x(), refused->y(), refused->z()));
    EXPECT_EQ(explained.exit_code, 0) << explained.output;
    EXPECT_NE(explained.output.find("unknown: the map was full and had no room for"), std::string::npos)
        << explained.output;
    // With another mapping it need not be the daemon's: whether that is complete nobody knows.
    const auto other = folder_.write("other.yaml", "base: paper\nmap: {memory_max_mib: 1}\n");
    EXPECT_EQ(octoskin("replay " + out() + " --fused-only --configuration " + other.string()).exit_code, 1);
}

TEST_F(DaemonRecording, is_whole_when_the_daemon_is_told_to_end_in_the_middle_of_it) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    ASSERT_TRUE(ask("record start 0 " + out())["ok"].get<bool>());
    std::this_thread::sleep_for(1s);
    daemon_->signal(SIGTERM);
    const auto ended = daemon_->wait(5s);
    ASSERT_TRUE(ended) << "did not end within 5 s";
    EXPECT_EQ(*ended, 0) << daemon_->log();
    expect_own_map();
    EXPECT_TRUE(ScratchFolder::read(out() + "/last.ot") == ScratchFolder::read(daemon_->maps() / "fused.ot"))
        << "the map of the recording is not the one that was saved";

    // Files that were changed since: the replay is no success, whatever it was that they lost.
    const std::string order = ScratchFolder::read(out() + "/order.log");
    const auto expect_unlike = [&](const std::string& changed, const std::string& why) {
        (void)folder_.write("recording/order.log", changed);
        const Said replay = octoskin("replay " + out() + " --fused-only");
        EXPECT_EQ(replay.exit_code, 1) << replay.output;
        EXPECT_NE(
            replay.output.find("differs from the daemon's, although only the recording was given: " + why),
            std::string::npos)
            << replay.output;
    };
    // All readings of the second half: a single one may have changed nothing in voxels that are sure already.
    const auto half = order.find("\nR ", order.size() / 2);
    ASSERT_NE(half, std::string::npos);
    const std::string of_nobody =
        std::regex_replace(order.substr(half), std::regex("\nR [0-9]+ "), "\nR 99 ");
    expect_unlike(order.substr(0, half) + of_nobody,
                  "input that the daemon used was rejected (see the input counters)");
    const auto crc = order.rfind(" last ");
    ASSERT_NE(crc, std::string::npos);
    expect_unlike(order.substr(0, crc) + " last 00000001\n", "files of the recording were changed");
    (void)folder_.write("recording/order.log", order);
    const std::string mapping = ScratchFolder::read(out() + "/mapping.yaml");
    const auto clamp = mapping.find("memory_max_mib: ");
    ASSERT_NE(clamp, std::string::npos) << mapping;
    (void)folder_.write("recording/mapping.yaml", mapping.substr(0, clamp) + "memory_max_mib: 77" +
                                                      mapping.substr(mapping.find('\n', clamp)));
    expect_own_map();  // what is otherwise changes nothing in this map
}

TEST_F(DaemonRecording, is_told_by_its_command_when_the_daemon_ends_in_the_middle_of_it) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    Said ran;
    std::thread command([&] { ran = record(out()); });
    EXPECT_TRUE(daemon_->wait_until(
        [](const Json& status) { return state_of_recording(status) == "recording"; }, 5s));
    daemon_->signal(SIGTERM);
    command.join();
    EXPECT_EQ(ran.exit_code, 1) << ran.output;
    EXPECT_NE(ran.output.find(out() + ": complete, but "), std::string::npos) << ran.output;
    EXPECT_NE(ran.output.find("the daemon ended"), std::string::npos) << ran.output;
}

TEST_F(DaemonRecording, ends_whole_when_another_rig_is_read_and_goes_on_while_it_is_the_same) {
    const std::string extends = "extends: " OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml\nname: ";
    start({"--no-camera"}, folder_.write("rig.yaml", extends + "first\n"));
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    ASSERT_TRUE(ask("record start 0 " + out())["ok"].get<bool>());
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return now["reloads"]["unchanged"] == 1; }, 5s));
    std::this_thread::sleep_for(1s);
    ASSERT_EQ(state_of_recording(daemon_->status()), "recording");
    folder_.write("rig.yaml", extends + "second\n");
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& status) { return state_of_recording(status) == "ended"; }, 5s))
        << daemon_->status()["recording"].dump();
    EXPECT_EQ(daemon_->status()["recording"]["ended_early"], "the daemon re-read its files (SIGHUP)");
    expect_own_map();
}

/// Its last map is of what it was recorded with.
TEST_F(DaemonRecording, ends_with_the_map_of_before_when_other_clamps_are_read) {
    const std::string fast = ScratchFolder::read(OCTOSKIN_SOURCE_DIR "/host/config/fast.yaml");
    const auto mapping = folder_.write("mapping.yaml", fast);
    start({"--no-camera", "--configuration", mapping.string()});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    ASSERT_TRUE(ask("record start 0 " + out())["ok"].get<bool>());
    std::this_thread::sleep_for(1s);
    const std::string key = "log_odds_min: ";
    const auto at = fast.find(key);
    ASSERT_NE(at, std::string::npos);
    folder_.write("mapping.yaml", fast.substr(0, at) + key + "-0.6" + fast.substr(fast.find('\n', at)));
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& status) { return state_of_recording(status) == "ended"; }, 5s))
        << daemon_->log();
    expect_own_map();
}

/// The recorder of OpenNI2 has them all in its memory until the end: it outlives the daemon for as long as
/// that takes.
TEST_F(DaemonRecording, of_a_killed_daemon_has_its_depth_frames) {
    const auto wall = record_wall(folder_, 24);
    start({"--camera", wall.string()});
    const auto depth_frames = [](const Json& now) {
        return now.value(Json::json_pointer("/recording/depth_frames"), 0);
    };
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    ASSERT_TRUE(ask("record start 0 " + out())["ok"].get<bool>());
    ASSERT_TRUE(daemon_->wait_until([&](const Json& now) { return depth_frames(now) >= 8; }, 15s))
        << daemon_->log();
    daemon_->signal(SIGKILL);
    EXPECT_EQ(daemon_->wait(5s), -SIGKILL);
    const std::string is_at_work = "pgrep -f '[o]ctoskin-oni-write " + out() + "' > /dev/null";
    for (int i = 0; i < 100 && std::system(is_at_work.c_str()) == 0; ++i) std::this_thread::sleep_for(100ms);
    std::istringstream order(ScratchFolder::read(out() + "/order.log"));
    std::string first_frame_us;
    int frames = 0;
    for (std::string line; std::getline(order, line);) {
        if (!line.starts_with("D ")) continue;
        if (++frames == 1) first_frame_us = std::to_string(std::stoll(line.substr(line.rfind(' '))) / 1000);
    }
    ASSERT_GE(frames, 5);
    std::ofstream(out() + "/meta.yaml") << "schema: octoskin-recording/1\nsource: robot\n";
    std::ofstream(out() + "/depth.epoch.yaml")
        << "schema: octoskin-depth-epoch/1\nfirst_frame_us: " << first_frame_us << "\nframes: " << frames
        << "\n";
    const Said replay = octoskin("replay " + out() + " --fused-only");
    EXPECT_EQ(replay.exit_code, 0) << replay.output;
    EXPECT_TRUE(std::filesystem::exists(out() + "/maps/fused.ot"));
}

TEST_F(DaemonRecording, of_a_killed_daemon_can_be_replayed_to_its_last_line) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    ASSERT_TRUE(ask("record start 0 " + out())["ok"].get<bool>());
    std::this_thread::sleep_for(1500ms);
    daemon_->signal(SIGKILL);
    EXPECT_EQ(daemon_->wait(5s), -SIGKILL);
    const Said without = octoskin("replay " + out());
    EXPECT_EQ(without.exit_code, 66) << without.output;
    EXPECT_NE(without.output.find("meta.yaml"), std::string::npos) << without.output;
    std::ofstream(out() + "/meta.yaml") << "schema: octoskin-recording/1\nsource: robot\n";
    const Said replay = octoskin("replay " + out());
    EXPECT_EQ(replay.exit_code, 0) << replay.output;
    EXPECT_NE(replay.output.find("order.log is cut off"), std::string::npos) << replay.output;
}

TEST_F(DaemonRecording, names_a_folder_that_it_cannot_record_to_and_goes_on) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    (void)folder_.write("file", "");
    const Said no_folder = record((folder_ / "file").string() + " --seconds 1");
    EXPECT_EQ(no_folder.exit_code, 73) << no_folder.output;
    EXPECT_NE(no_folder.output.find((folder_ / "file").string()), std::string::npos) << no_folder.output;
    const Said not_empty = record(folder_.path().string() + " --seconds 1");
    EXPECT_EQ(not_empty.exit_code, 73) << not_empty.output;
    EXPECT_NE(not_empty.output.find("is not empty"), std::string::npos) << not_empty.output;
    EXPECT_TRUE(daemon_->status()["recording"].is_null()) << "a refusal leaves no trace";
    EXPECT_FALSE(has_problem(daemon_->status(), "recording"));
    const std::string log = daemon_->log();
    const auto reported = log.find("is not empty");
    EXPECT_NE(reported, std::string::npos) << log;
    EXPECT_EQ(log.find("is not empty", reported + 1), std::string::npos) << "twice:\n" << log;
    EXPECT_EQ(log.find("recording to"), std::string::npos) << log;

    ASSERT_TRUE(ask("record start 0 " + out())["ok"].get<bool>());
    expect_refusal("record start 0 " + out(), 73, {{"code", "in_use"}, {"file", out()}});  // a second one
    expect_refusal("record start -1 /x", 64, {{"code", "bad_argument"}});
    expect_refusal("record start 0 relative", 64, {{"code", "bad_value"}, {"value", "'relative'"}});
    expect_refusal("record tape", 64, {{"code", "bad_argument"}});
    const Said others = record("--stop " + (folder_ / "others").string());
    EXPECT_EQ(others.exit_code, 69) << others.output;
    EXPECT_NE(others.output.find("is not being recorded; the recording goes to " + out()), std::string::npos);
    const Said stopped = record("--stop " + out());
    EXPECT_EQ(stopped.exit_code, 0) << stopped.output;
    expect_own_map();
    const Said stopped_again = record("--stop");
    EXPECT_EQ(stopped_again.exit_code, 69) << stopped_again.output;
    EXPECT_NE(stopped_again.output.find("nothing is being recorded"), std::string::npos)
        << stopped_again.output;
}

}  // namespace
}  // namespace octoskin::test
