// What a daemon's map is worth after a restart: as old as it is, or stale where that is not known.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <string>
#include <thread>

#include "common/wire/crc.hpp"
#include "host/apps/daemon/boot_clock.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/map_saver.hpp"
#include "host/apps/query/query_request.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

class Restarting : public testing::Test {
  protected:
    /// All about the arm is free, as a camera saw just when the map's clock showed what it shows.
    static FusedMap free_map() {
        MapLayers layers;
        StampTree stamps;
        const VoxelAges::Clock clock{
            .has_begun = true, .runs_for_s = 100, .zero_s = 0, .now = VoxelAges::kAgeMax_s};
        const std::uint16_t seen = VoxelAges(clock, {}).stamp(SensorKind::camera);
        constexpr std::uint16_t kFrom = 32768 - 64;
        constexpr std::uint16_t kTo = 32768 + 64;
        for (std::uint16_t x = kFrom; x < kTo; x += kBrickEdge)
            for (std::uint16_t y = kFrom; y < kTo; y += kBrickEdge)
                for (std::uint16_t z = kFrom; z < kTo; z += kBrickEdge) {
                    layers.log_odds.set_all(brick_of({x, y, z}), -2.0F);
                    stamps.set_all(brick_of({x, y, z}), seen);
                    layers.known_voxels += kBrickVoxels;
                }
        layers.ages = VoxelAges(clock, std::move(stamps));
        return {denoised_mapping().map, std::move(layers), false};
    }
    static std::uint32_t placement_of(const std::filesystem::path& rig_file) {
        const auto rig = rig::read_rig(rig_file);
        EXPECT_TRUE(rig) << rig.error().message();
        return rig ? rig::placement_crc32(*rig, testing_support::ScratchFolder::read(rig->urdf.shown())) : 0;
    }
    /// As a daemon of then would have left it.
    void save(const std::optional<BootTime>& map_time, const std::filesystem::path& rig = kExperiment) const {
        std::filesystem::create_directories(folder_ / "maps");
        const std::string text = mapping_text(denoised_mapping());
        const SnapshotOrigin origin{
            .mapping_crc32 = crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}),
            .placement_crc32 = placement_of(rig),
            .map_time = map_time};
        EXPECT_EQ(MapSaver::write_map(free_map(), origin, NamedFolder(folder_ / "maps")), "");
    }
    /// What a daemon on a silent bus says of the arm upright.
    struct Answer {
        std::string state;
        Json age_s;
        std::string log;
    };
    Answer ask(std::chrono::milliseconds runs_for = 0ms) const {
        const SilentBus bus;
        RunningDaemon daemon(folder_, bus.end_of_daemon(), {"--no-camera"});
        EXPECT_TRUE(daemon.wait_until([](const Json& status) { return !status.is_null(); }, 15s));
        std::this_thread::sleep_for(runs_for);
        Answer answer = ask(daemon);
        daemon.signal(SIGTERM);
        EXPECT_EQ(daemon.wait(10s), 0) << daemon.log();
        answer.log = daemon.log();
        return answer;
    }
    Answer ask(const RunningDaemon& daemon) const {
        QueryRequest request;
        request.path = {{0.0, 0.0, 0.0, -0.1, 0.0, 1.6, 0.0}};
        const auto line = ask_daemon(folder_ / "control", to_line(request), 30s);
        EXPECT_TRUE(line) << daemon.log();
        const Json answer = line ? Json::parse(*line) : Json::object();
        return {answer.value("state", ""), answer.value(Json::json_pointer("/legs/0/evidence/age_s"), Json()),
                daemon.log()};
    }
    /// The experiment's rig, called so and with its base so many metres further along x.
    std::filesystem::path rig_moved_by(double x_m, const std::string& name) const {
        return folder_.write("rig.yaml",
                             fmt::format("extends: {}\nname: {}\nT_map_base: {{xyz_m: [{}, 0, 0], "
                                         "rpy_deg: [0, 0, 0]}}\n",
                                         kExperiment, name, x_m));
    }
    static BootTime ago(Nanoseconds time) {
        BootTime then = boot_now().value();
        then.since_boot -= time;
        return then;
    }

    testing_support::ScratchFolder folder_;
};

TEST_F(Restarting, of_the_daemon_makes_the_map_older_by_what_passed_and_free_stays_free) {
    if (!boot_now() || boot_now()->since_boot < 200s) GTEST_SKIP() << "no boot that is so long ago";
    save(ago(20s));
    const Answer first = ask();
    EXPECT_EQ(first.state, "free") << first.log;
    ASSERT_TRUE(first.age_s.is_number()) << first.log;
    EXPECT_GE(first.age_s, 20);
    EXPECT_LT(first.age_s, 40);
    const Answer second = ask(3s);  // goes on from what the first one saved
    EXPECT_EQ(second.state, "free") << second.log;
    EXPECT_GE(second.age_s.get<int>(), first.age_s.get<int>() + 3);
    EXPECT_LT(second.age_s, 55);
    save(ago(70s));
    const Answer stale = ask();
    EXPECT_EQ(stale.state, "stale") << stale.log;
    EXPECT_GE(stale.age_s, 70);
}

TEST_F(Restarting, of_the_machine_leaves_everything_stale) {
    BootTime other = boot_now().value_or(BootTime{});
    other.boot.front() ^= 1U;
    for (const auto& map_time : {std::optional(other), std::optional<BootTime>()}) {
        save(map_time);
        const Answer answer = ask();
        EXPECT_EQ(answer.state, "stale") << answer.log;
        EXPECT_TRUE(answer.age_s.is_null()) << answer.log;
    }
}

// What the map has may then lie elsewhere than the robot finds it.
TEST_F(Restarting, with_a_rig_that_places_the_base_elsewhere_leaves_everything_stale) {
    save(ago(1s), rig_moved_by(0.2, "moved"));
    EXPECT_EQ(ask().state, "stale");
}

TEST_F(Restarting, is_not_needed_for_a_rig_that_is_read_anew_and_places_the_base_elsewhere) {
    save(ago(1s));
    const auto rig = rig_moved_by(0.0, "first");
    const SilentBus bus;
    RunningDaemon daemon(folder_, bus.end_of_daemon(), {"--no-camera"}, rig);
    const auto becomes = [&](const std::string& name) {
        return daemon.wait_until(
            [&](const Json& status) { return !status.is_null() && status["rig"] == name; }, 15s);
    };
    ASSERT_TRUE(becomes("first")) << daemon.log();
    EXPECT_EQ(ask(daemon).state, "free") << "the rig that it was saved with, but for its name";
    (void)rig_moved_by(0.0, "second");
    daemon.signal(SIGHUP);
    ASSERT_TRUE(becomes("second")) << daemon.log();
    EXPECT_EQ(ask(daemon).state, "free");
    (void)rig_moved_by(0.2, "third");
    daemon.signal(SIGHUP);
    ASSERT_TRUE(becomes("third")) << daemon.log();
    EXPECT_EQ(ask(daemon).state, "stale");
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(10s), 0) << daemon.log();
}

TEST_F(Restarting, with_a_damaged_snapshot_goes_on_from_the_ot_and_says_so) {
    save(ago(1s));
    const std::string file = (folder_ / "maps" / "fused.snapshot").string();
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
    const Answer answer = ask();
    EXPECT_EQ(answer.state, "stale") << answer.log;
    EXPECT_NE(answer.log.find(file + ": byte "), std::string::npos) << answer.log;
    const std::string of_both = ask().log;  // one behind the other
    EXPECT_EQ(of_both.find(file), of_both.rfind(file)) << "the one before saved a whole one" << of_both;
}

}  // namespace
}  // namespace octoskin::test
