#include "host/apps/daemon/settings.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <random>
#include <string>
#include <thread>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

constexpr const char* kPanda = OCTOSKIN_SOURCE_DIR "/hw/robots/panda.urdf";
constexpr const char* kBench = OCTOSKIN_SOURCE_DIR "/hw/rigs/bench_one_board.yaml";

/// An editor that saves now this robot, now that.
class Saving {
  public:
    /// Waits for up to `pause_max` before it saves again.
    Saving(const ScratchFolder& folder, const std::string& one, const std::string& other,
           std::chrono::microseconds pause_max) {
        thread_ = std::thread([this, &folder, one, other, pause_max] {
            std::mt19937 random(7);
            std::uniform_int_distribution<std::int64_t> pause_us(0, pause_max.count());
            for (bool is_one = true; !is_ending_; is_one = !is_one) {
                std::filesystem::rename(folder.write("next.urdf", is_one ? one : other),
                                        folder / "robot.urdf");
                std::this_thread::sleep_for(std::chrono::microseconds(pause_us(random)));
            }
        });
    }
    ~Saving() {
        is_ending_ = true;
        thread_.join();
    }
    Saving(const Saving&) = delete;
    Saving& operator=(const Saving&) = delete;

  private:
    std::atomic<bool> is_ending_ = false;
    std::thread thread_;
};

// The daemon would live with one robot and record another.
TEST(Settings, are_of_one_robot_however_often_its_file_is_saved_anew_meanwhile) {
    const ScratchFolder folder;
    const std::string panda = ScratchFolder::read(kPanda);
    std::string other = panda;
    const std::string limit = "upper=\"2.8973\"";
    ASSERT_NE(other.find(limit), std::string::npos);
    other.replace(other.find(limit), limit.size(), "upper=\"1.25\"");
    folder.write("robot.urdf", panda);
    folder.write("rig.yaml",
                 fmt::format("extends: {}\nrobot: {{urdf: {}}}\n", kBench, (folder / "robot.urdf").string()));
    DaemonRequest request;
    request.rig = folder / "rig.yaml";
    const auto begun = std::chrono::steady_clock::now();
    ASSERT_TRUE(read_settings(request));
    const auto takes = std::chrono::steady_clock::now() - begun;
    const Saving saving(folder, panda, other, std::chrono::ceil<std::chrono::microseconds>(4 * takes));
    int read = 0;
    for (int i = 0; i < 60; ++i) {
        const auto settings = read_settings(request);
        if (!settings) continue;
        ++read;
        const double upper = settings->host.robot.limits().front().max;
        EXPECT_EQ(upper, settings->recorded.robot == panda ? 2.8973 : 1.25) << i;
    }
    EXPECT_GT(read, 0);
}

/// Cameras of a daemon's rig, each with its device.
class CameraSettings : public testing::Test {
  protected:
    /// Of the bench's rig with these cameras, each with one pixel.
    Result<Settings, AppError> read(const std::string& cameras, const std::vector<std::string>& given) {
        folder_.write("rig.yaml", std::string("extends: ") + kBench + "\n" + cameras);
        DaemonRequest request;
        request.rig = folder_ / "rig.yaml";
        request.cameras = given;
        return read_settings(request);
    }
    static std::string keys(const std::string& first) {
        return "{" + first +
               "width_px: 1, height_px: 1, fx_px: 1, fy_px: 1, cx_px: 0.5, cy_px: 0.5, rate_hz: 10, "
               "pose: {xyz_m: [1, 0, 1], rpy_deg: [0, 0, 0]}}";
    }
    static std::string two(const std::string& first = "", const std::string& second = "") {
        return "cameras:\n  - " + keys("name: front, " + first) + "\n  - " + keys("name: back, " + second) +
               "\n";
    }
    ErrorCode refusal(const std::string& cameras, const std::vector<std::string>& given) {
        const auto settings = read(cameras, given);
        EXPECT_FALSE(settings);
        if (!settings) {
            EXPECT_EQ(settings.error().exit, ExitCode::usage);
            EXPECT_FALSE(settings.error().error.remedy.empty());
        }
        return settings ? ErrorCode::self_check : settings.error().error.code;
    }
    ScratchFolder folder_;
};

TEST_F(CameraSettings, take_devices_from_the_rig_or_by_name) {
    const auto settings = read(two("device: x, ", "device: y, "), {"back=z=1"});
    ASSERT_TRUE(settings) << settings.error().error.message();
    EXPECT_EQ(settings->host.rig.cameras[0].device, "x");
    EXPECT_EQ(settings->host.rig.cameras[1].device, "z=1");
    EXPECT_EQ(settings->recorded.rig.find("device"), std::string::npos) << "of this machine";
    EXPECT_EQ(settings->recorded.form.cameras, 2U);
    EXPECT_EQ(settings->recorded.cameras, (std::vector<std::string>{"front", "back"}));
    const auto other = read(two("device: x, ", "device: y, "), {"back=w"});
    ASSERT_TRUE(other);
    EXPECT_FALSE(other->recorded == settings->recorded) << "a reload would not open it";
    EXPECT_EQ(other->recorded.rig_hash, settings->recorded.rig_hash);
    const auto one = read("camera: " + keys("") + "\n", {"any/a=b"});
    ASSERT_TRUE(one) << one.error().error.message();
    EXPECT_EQ(one->host.rig.cameras.at(0).device, "any/a=b");
    const auto fed = read(two("device: x, ", "device: y, "), {"back=ros:/camera/depth"});
    ASSERT_TRUE(fed) << fed.error().error.message();
    EXPECT_EQ(fed->host.rig.cameras[1].device, "ros:/camera/depth");
}

TEST_F(CameraSettings, refuse_unknown_names_and_devices_that_are_missing_shared_or_given_twice) {
    EXPECT_EQ(refusal(two("device: x, "), {}), ErrorCode::missing_key);
    EXPECT_EQ(refusal(two("device: x, ", "device: y, "), {"left=z"}), ErrorCode::unknown_name);
    EXPECT_EQ(refusal(two("device: x, ", "device: y, "), {"z"}), ErrorCode::unknown_name);
    EXPECT_EQ(refusal(two("device: x, ", "device: y, "), {"back=x"}), ErrorCode::duplicate);
    EXPECT_EQ(refusal(two(), {"front=x", "back=y", "front=z"}), ErrorCode::duplicate);
    const std::string one = "camera: " + keys("") + "\n";
    EXPECT_EQ(refusal(one, {"front=x"}), ErrorCode::unknown_name);
    EXPECT_EQ(refusal(one, {"x", "y"}), ErrorCode::duplicate);
    EXPECT_EQ(refusal("cameras:\n  - " + keys("name: front, ") + "\n", {"left=x"}), ErrorCode::unknown_name);
    EXPECT_EQ(refusal("", {"x"}), ErrorCode::conflict);
    folder_.write("film.oni", "any");
    EXPECT_EQ(refusal(one, {"ros:depth"}), ErrorCode::bad_value);
    EXPECT_EQ(refusal(two(), {"front=x", "back=ros:/depth/"}), ErrorCode::bad_value);
    EXPECT_EQ(refusal(two(), {"front=ros:/depth", "back=ros:/depth"}), ErrorCode::duplicate);
    EXPECT_EQ(refusal(two("device: 'ros:/depth', "), {"back=ros:/depth"}), ErrorCode::duplicate);
    std::filesystem::create_symlink("film.oni", folder_ / "same.oni");
    EXPECT_EQ(refusal(two(), {"front=" + (folder_ / "film.oni").string(),
                              "back=" + (folder_ / "same.oni").string()}),
              ErrorCode::duplicate);
}

}  // namespace
}  // namespace octoskin
