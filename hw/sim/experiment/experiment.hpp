// The whole rig in one process, on one virtual clock and from one seed: sensors, boards, bus, arm controller,
// cameras and the host's transmissions. The output is that of a recorder: frames on the bus and depth images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/arm/body.hpp"
#include "hw/sim/experiment/emulated_board.hpp"
#include "hw/sim/experiment/rig_board.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/moving_world.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::sim {

struct ExperimentInput {
    const rig::Rig& rig;
    const Body& body;  ///< the true one: without the rig's padding
    const World& world;
    const Arm& arm;
    const Scenario& scenario;
    std::uint64_t seed = 0;
    bool is_depth_noise_free = false;
    std::optional<EmulatedBoards> emulated{};  ///< the flashed image in place of the node core here
    /// Of boards in this process: one for each node, or none. Then they run from time 0, and their counters
    /// start at random values.
    std::vector<BoardStart> board_starts{};
    /// Motions of models of `world`, each model once (asserted); seconds from the start of the arm's motion.
    std::vector<ModelMotion> motions{};
};

/// The true data of a ranging, for tests: no recorder has them.
struct TrueRanging {
    std::uint8_t node_id = 0;
    std::uint8_t sensor = 0;
    std::uint32_t index = 0;  ///< since the sensor's power-up
    SimTime window_middle{};
    RangingReturn seen;
};

/// An image of one of the rig's cameras.
struct CameraImage {
    std::size_t camera = 0;  ///< index in Rig::cameras
    HostTime captured;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint16_t> depth_mm;
};

/// Handlers of a recorder. `captured` and `stamp` are in the clocks of a real recorder.
struct ExperimentOutput {
    std::function<void(const wire::CanFrame& frame, WallTime stamp)> on_frame;
    /// Of all cameras in the order of capture; at the same instant in the order of the rig.
    std::function<void(CameraImage image)> on_depth;
    std::function<void(double fraction)> on_progress;
    std::function<void(const TrueRanging&)> on_ranging{};  ///< for tests
};

struct ExperimentSummary {
    double duration_s = 0.0;
    std::uint64_t can_frames = 0;
    std::uint64_t depth_frames = 0;  ///< of all cameras
    double can_busy_fraction = 0.0;
    std::vector<double> i2c_busy_fraction;  ///< per node and bus
    double first_range_s = 0.0;             ///< time of the first range on the bus
    std::vector<BoardStart> board_starts;   ///< the true values of each node
    std::string violations;                 ///< of emulated boards, one a line
};

/// Runs it from power-up to the STOP mark. An error has the key of the scenario, if that is at fault, and no
/// file. Same input, same output, to the bit. About 1 s for the sensors and
/// 0.1 s for each depth frame.
[[nodiscard]] Result<ExperimentSummary, Error> run_experiment(const ExperimentInput& input,
                                                              const ExperimentOutput& output);

}  // namespace octoskin::sim
