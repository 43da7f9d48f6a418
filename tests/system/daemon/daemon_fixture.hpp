// A daemon on a bus that is alive: the sensor boards of the experiment, played in real time, which answer its
// SYNC.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/core/pipeline/can_source.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/support/live/live_bus.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/system/daemon/running_daemon.hpp"

namespace octoskin::test {

/// The frames of the experiment's rig: 2 s at rest, then the arm moves.
[[nodiscard]] const std::vector<StampedFrame>& log_of_experiment();
/// The same of another rig, or with more revolutions of the arm, of 10 s each, before its joints jump.
[[nodiscard]] std::vector<StampedFrame> make_log(rig::Rig rig, std::uint32_t revolutions = 1);

/// Twenty frames of a wall 3 m away, at 10 Hz, through OpenNI2's own recorder: in the first `columns` of 512,
/// nothing in the others. A narrow one contradicts no range sensor.
[[nodiscard]] std::filesystem::path record_wall(const testing_support::ScratchFolder& folder,
                                                std::size_t columns = 512);

/// A bus on which nobody is.
class SilentBus {
  public:
    SilentBus();
    ~SilentBus();
    SilentBus(const SilentBus&) = delete;
    SilentBus& operator=(const SilentBus&) = delete;
    /// For one daemon, which closes it.
    [[nodiscard]] int end_of_daemon() const { return ends_[0]; }

  private:
    std::array<int, 2> ends_{};
};

class DaemonTest : public testing::Test {
  protected:
    DaemonTest();
    void start(const std::vector<std::string>& more_arguments = {"--no-camera"},
               const std::filesystem::path& rig = kExperiment,
               const std::vector<StampedFrame>& log = log_of_experiment());
    /// Takes the processor from it for so long. What it tells of itself before and after.
    struct Pause {
        nlohmann::json before, after;
    };
    [[nodiscard]] Pause hold_up(std::chrono::milliseconds duration) const;
    static int readings_used(const nlohmann::json& status) {
        return status["inputs"]["readings"]["used"].get<int>();
    }
    static bool is_ranging(const nlohmann::json& status) { return readings_used(status) > 100; }
    /// The code of a problem is this text, or its sentence contains it.
    static bool has_problem(const nlohmann::json& status, const std::string& text);

    testing_support::ScratchFolder folder_;
    int its_end_ = -1;
    int our_end_ = -1;
    std::optional<RunningDaemon> daemon_;
    std::optional<LiveBus> bus_;
};

}  // namespace octoskin::test
