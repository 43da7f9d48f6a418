// A daemon with two cameras: each is read, counted, lost and recorded by itself.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/system/daemon/daemon_fixture.hpp"
#include "tests/system/said.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using testing_support::ScratchFolder;

constexpr const char* kFrames = "depth frames of ";

class SeveralCameras : public DaemonTest {
  protected:
    /// The experiment's rig with its camera twice, a metre apart, each with its own film.
    std::filesystem::path rig(const std::string& back_device = "back.oni") {
        const rig::Rig given = rig::read_rig(kExperiment).value();
        const rig::Camera& camera = given.cameras.front();
        std::ofstream file(folder_ / "two.yaml");
        file << "extends: " << std::string(kExperiment) << "\ncamera: ~\ncameras:\n";
        for (const std::string name : {"front", "back"}) {
            const double x_m = camera.T_link_camera.translation().x() + (name == "back" ? 1.0 : 0.0);
            file << "  - {name: " << name << ", device: " << (name == "back" ? back_device : "front.oni")
                 << ", width_px: " << camera.width << ", height_px: " << camera.height
                 << ", fx_px: " << camera.fx << ", fy_px: " << camera.fy << ", cx_px: " << camera.cx
                 << ", cy_px: " << camera.cy << ", rate_hz: 10, pose: {xyz_m: [" << x_m << ", "
                 << camera.T_link_camera.translation().y() << ", " << camera.T_link_camera.translation().z()
                 << "], looking_at_m: [0, 0, 0.5]}}\n";
        }
        return folder_ / "two.yaml";
    }
    /// A film of a narrow wall, which contradicts no sensor.
    std::filesystem::path film(const std::string& name) {
        std::filesystem::rename(record_wall(folder_, 24), folder_ / name);
        return folder_ / name;
    }
    static int used(const Json& status, const std::string& camera) {
        return status["inputs"][kFrames + camera]["used"].get<int>();
    }
    bool wait_for_both() {
        return daemon_
            ->wait_until([](const Json& now) { return used(now, "front") >= 5 && used(now, "back") >= 5; },
                         20s)
            .has_value();
    }
};

TEST_F(SeveralCameras, are_recorded_in_files_of_their_own_and_replay_to_the_daemons_map_byte_for_byte) {
    (void)film("front.oni");
    (void)film("back.oni");
    start({}, rig());
    ASSERT_TRUE(wait_for_both()) << daemon_->status()["inputs"].dump(1) << daemon_->log();
    const std::string out = (folder_ / "recording").string();
    const Said recorded =
        octoskin("record " + out + " --seconds 4 --socket " + (folder_ / "control").string());
    ASSERT_EQ(recorded.exit_code, 0) << recorded.output << daemon_->log();
    EXPECT_TRUE(daemon_->status()["recording"]["is_complete"].get<bool>());
    for (const char* name :
         {"depth/front.oni", "depth/front.epoch.yaml", "depth/back.oni", "depth/back.epoch.yaml"})
        EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::path(out) / name)) << name;
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(out) / "depth.oni"));
    EXPECT_EQ(ScratchFolder::read(out + "/rig.yaml").find(".oni"), std::string::npos) << "no device";
    EXPECT_NE(ScratchFolder::read(out + "/order.log").find(" cameras 2 "), std::string::npos);
    const Said replay = octoskin("replay " + out + " --fused-only");
    EXPECT_EQ(replay.exit_code, 0) << replay.output;
    EXPECT_NE(replay.output.find("identical to the daemon's, byte for byte"), std::string::npos)
        << replay.output;
    EXPECT_TRUE(ScratchFolder::read(out + "/maps/fused.ot") == ScratchFolder::read(out + "/last.ot"));
}

TEST_F(SeveralCameras, are_lost_and_come_back_each_by_itself) {
    (void)film("front.oni");
    const auto back = film("back.oni");
    start({}, rig());
    ASSERT_TRUE(wait_for_both()) << daemon_->status()["inputs"].dump(1) << daemon_->log();
    std::filesystem::remove(back);
    const std::string helper = "pkill -KILL -f '[o]ctoskin-film " + back.string() + "'";
    ASSERT_EQ(std::system(helper.c_str()), 0);
    const auto reported =
        daemon_->wait_until([](const Json& now) { return has_problem(now, "camera 'back'"); }, 3s);
    ASSERT_TRUE(reported) << daemon_->status()["problems"].dump(1);
    EXPECT_LE(*reported, 1s);
    const Json lost = daemon_->status();
    EXPECT_FALSE(has_problem(lost, "camera 'front'")) << lost["problems"].dump(1);
    EXPECT_TRUE(lost["cameras"][0]["open"].get<bool>());
    EXPECT_FALSE(lost["cameras"][1]["open"].get<bool>());
    EXPECT_TRUE(daemon_->wait_until(
        [&](const Json& now) { return used(now, "front") > used(lost, "front") + 5; }, 5s));
    (void)film("back.oni");
    const auto returned = daemon_->wait_until(
        [&](const Json& now) { return used(now, "back") > used(lost, "back") && now["problems"].empty(); },
        10s);
    EXPECT_TRUE(returned) << daemon_->status()["problems"].dump(1) << daemon_->log();
}

TEST_F(SeveralCameras, of_one_device_or_without_one_are_refused_by_name_at_the_start_and_at_a_reload) {
    (void)film("front.oni");
    (void)film("back.oni");
    const auto good = rig();
    start({}, good);
    ASSERT_TRUE(wait_for_both()) << daemon_->log();
    const Json before = daemon_->status();
    (void)rig("front.oni");  // over the good one
    daemon_->signal(SIGHUP);
    EXPECT_TRUE(
        daemon_->wait_until([](const Json& now) { return has_problem(now, "cameras[1].device"); }, 2s))
        << daemon_->status()["problems"].dump(1);
    EXPECT_TRUE(
        daemon_->wait_until([&](const Json& now) { return used(now, "back") > used(before, "back"); }, 5s))
        << "it goes on with the rig that it has";

    const std::string run = "run --can can-none --maps " + (folder_ / "other").string() + " --socket " +
                            (folder_ / "other.sock").string() + " --rig " + good.string();
    EXPECT_NE(octoskin(run).exit_code, 0);
    (void)rig();
    const Said twice = octoskin(run + " --camera back=" + (folder_ / "front.oni").string());
    EXPECT_EQ(twice.exit_code, 64) << twice.output;
    EXPECT_NE(twice.output.find("'front' and camera 'back' have the same device"), std::string::npos)
        << twice.output;
    const Said unknown = octoskin(run + " --camera left=x");
    EXPECT_EQ(unknown.exit_code, 64) << unknown.output;
    EXPECT_NE(unknown.output.find("front, back"), std::string::npos) << unknown.output;
}

}  // namespace
}  // namespace octoskin::test
