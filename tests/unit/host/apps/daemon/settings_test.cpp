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

}  // namespace
}  // namespace octoskin
