#include "hw/sim/experiment/experiment.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <memory>
#include <random>

#include "common/wire/codec.hpp"
#include "hw/sim/camera/sensor_scene.hpp"
#include "hw/sim/can/simulated_can_bus.hpp"
#include "hw/sim/experiment/joint_node.hpp"
#include "hw/sim/experiment/rig_camera.hpp"
#include "hw/sim/experiment/simulated_board.hpp"
#include "hw/sim/experiment/sync_master.hpp"

namespace octoskin::sim {
namespace {

// Period of the simulation's loop, in which every board polls. Longer than a byte on the bus, a fifth of a
// transfer.
constexpr std::int64_t kTurnUs = 50;
// With boards in separate processes, each turn costs a round trip. Their frames reach the bus at the end of a
// turn; they receive frames at the exact time.
constexpr std::int64_t kRemoteTurnUs = 200;
constexpr Microseconds kSyncPeriod{1'000'000};
// The host's clocks at the start: up for a while, and an arbitrary wall time.
constexpr HostTime kHostAtStart{4'321'000'000'000};
constexpr WallTime kWallAtStart{1'750'000'000'000'000'000};

SimTime from_seconds(double seconds) {
    return {static_cast<std::int64_t>(std::llround(seconds * 1e6))};
}

/// Crystals are within +-100 ppm; counters start at a random value, the first node's shortly before it wraps.
NodeClock draw_clock(std::mt19937_64& random, bool is_first) {
    const auto start = static_cast<std::uint32_t>(random() & 0xFFFFFFFFU);
    const double drift_ppm = static_cast<double>(random() % 2001) / 10.0 - 100.0;
    return {NodeTime{is_first ? 0U - 6'000'000U : start}, drift_ppm};
}

using WorldAt = std::function<const World&(SimTime)>;

/// Empty if nothing moves. Holds the world of one instant at a time.
WorldAt world_at(const ExperimentInput& input, SimTime start) {
    if (input.motions.empty()) return {};
    const auto moving = std::make_shared<MovingWorld>(input.world.solids(), input.motions);
    return [moving, start](SimTime time) -> const World& {
        return moving->at(1e-6 * static_cast<double>(time.us - start.us));
    };
}

/// All parts of the simulation, connected.
class RigInOneProcess {
  public:
    RigInOneProcess(const ExperimentInput& input, const Trajectory& trajectory, const WorldAt& world_at,
                    const ExperimentOutput& output)
        : output_(output),
          turn_us_(input.emulated ? kRemoteTurnUs : kTurnUs),
          surroundings_{.world = input.world,
                        .arm = input.arm,
                        .trajectory = trajectory,
                        .body = input.body,
                        .ignored_links = input.rig.links_ignored_by_sensors,
                        .optics = input.scenario.ranges,
                        .seed = input.seed,
                        .world_at = world_at},
          bus_({input.rig.bus.nominal_bitrate, input.rig.bus.data_bitrate}),
          master_(SimulatedHostClock(kHostAtStart), kSyncPeriod) {
        std::mt19937_64 random(input.seed);
        bus_.tap([this](const wire::CanFrame& frame, SimTime end) { record(frame, end); });
        host_ = &bus_.attach([](const wire::CanFrame&, SimTime) {}, 16);
        for (const rig::Node& node : input.rig.nodes) {
            const NodeClock clock = draw_clock(random, boards_.empty());
            const SceneOfSensor scene = [&](std::uint8_t sensor) {
                return reported(ranging_scene(surroundings_, mount_of(node, sensor)), node.config.node_id,
                                sensor);
            };
            boards_.push_back(make_board(input, node.config, clock, scene));
        }
        std::size_t first = 0;
        for (const rig::JointSource& source : input.rig.joint_sources) {
            const JointPositions positions = [&trajectory, first,
                                              count = source.joints.size()](SimTime time) {
                const Eigen::VectorXd q = trajectory.at(time);
                return std::vector<double>(q.data() + first, q.data() + first + count);
            };
            auto node = std::make_unique<JointNode>(source.node_id, source.rate_hz, draw_clock(random, false),
                                                    positions);
            const auto on_frame = [node = node.get()](const wire::CanFrame& frame, SimTime end) {
                node->on_frame(frame, end);
            };
            joints_.push_back({std::move(node), &bus_.attach(on_frame, 16)});
            first += source.joints.size();
        }
    }

    /// Queues a mark to send at `at`.
    void mark(wire::MarkKind kind, SimTime at) { marks_.push_back({kind, at}); }

    void run_until(SimTime end) {
        while (present_.time < end) {
            present_.time.us += turn_us_;
            bus_.advance(present_.time);
            send_marks();
            for (const auto& board : boards_) board->begin_turn(present_.time);
            for (const auto& board : boards_) board->finish_turn();
            for (const JointSender& sender : joints_)
                send_all(sender.node->poll(present_.time), *sender.transmitter);
            send_all(master_.poll(present_.time), *host_);
        }
    }

    [[nodiscard]] SimTime now() const { return present_.time; }

    [[nodiscard]] ExperimentSummary summary() const {
        ExperimentSummary summary = summary_;
        summary.duration_s = static_cast<double>(present_.time.us) * 1e-6;
        summary.can_busy_fraction = bus_.busy_fraction();
        for (const auto& board : boards_) {
            for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus) {
                summary.i2c_busy_fraction.push_back(board->i2c_busy_s(bus) / summary.duration_s);
            }
            summary.board_starts.push_back(board->start());
            summary.violations += board->violations();
        }
        return summary;
    }

  private:
    /// The same scene, which also reports each ranging to the caller's handler.
    RangingScene reported(RangingScene scene, std::uint8_t node_id, std::uint8_t sensor) const {
        if (!output_.on_ranging) return scene;
        return [this, scene = std::move(scene), node_id, sensor](std::uint32_t index, SimTime middle,
                                                                 const Roi& roi) {
            const RangingReturn seen = scene(index, middle, roi);
            output_.on_ranging({node_id, sensor, index, middle, seen});
            return seen;
        };
    }

    std::unique_ptr<RigBoard> make_board(const ExperimentInput& input, const NodeConfig& config,
                                         NodeClock clock, const SceneOfSensor& scene) {
        const PartsReel reel{input.seed, input.scenario.slow_clocks, input.scenario.sensor_traits};
        if (input.emulated) {
            return std::make_unique<EmulatedBoard>(*input.emulated, config, clock.drift_ppm(), reel, bus_,
                                                   scene);
        }
        BoardStart start{.clock = clock, .first_turn = {}};
        if (!input.board_starts.empty()) start = input.board_starts.at(boards_.size());
        return std::make_unique<SimulatedBoard>(config, start, reel, bus_, scene);
    }

    struct ScheduledMark {
        wire::MarkKind kind;
        SimTime at;
    };

    void send_marks() {
        while (!marks_.empty() && present_.time >= marks_.front().at) {
            master_.mark(marks_.front().kind, marks_.front().at);
            marks_.pop_front();
        }
    }

    // The mailboxes outnumber what either sends at once (four joint frames, a heartbeat, a report).
    static void send_all(const std::vector<wire::CanFrame>& frames, node::CanTransmitter& transmitter) {
        for (const wire::CanFrame& frame : frames) {
            const bool is_sent = transmitter.send(frame);
            assert(is_sent);
            static_cast<void>(is_sent);
        }
    }

    void record(const wire::CanFrame& frame, SimTime end) {
        master_.on_frame(frame, end);
        ++summary_.can_frames;
        if (summary_.first_range_s == 0.0 && is_range(frame))
            summary_.first_range_s = static_cast<double>(end.us) * 1e-6;
        output_.on_frame(frame, WallTime{kWallAtStart.ns + end.us * 1000});
    }

    static bool is_range(const wire::CanFrame& frame) {
        const wire::FrameType type = wire::type_of(frame.can_id);
        return type == wire::FrameType::range || type == wire::FrameType::range_fd;
    }

    static SensorMount mount_of(const rig::Node& node, std::uint8_t sensor) {
        const rig::Sensor& mounted = node.sensors.at(sensor);
        return {mounted.link, mounted.T_link_sensor, node.config.node_id * 64U + sensor, mounted.cone};
    }

    const ExperimentOutput& output_;
    std::int64_t turn_us_;
    SensorSurroundings surroundings_;
    Present present_;
    SimulatedCanBus bus_;
    SyncMaster master_;
    node::CanTransmitter* host_ = nullptr;
    std::vector<std::unique_ptr<RigBoard>> boards_;
    struct JointSender {
        std::unique_ptr<JointNode> node;
        node::CanTransmitter* transmitter = nullptr;
    };
    std::vector<JointSender> joints_;  ///< one for each source of the rig
    std::deque<ScheduledMark> marks_;
    ExperimentSummary summary_;
};

}  // namespace

namespace {

std::vector<RigCamera> cameras_of(const ExperimentInput& input, const CameraSurroundings& around,
                                  SimTime start) {
    const DepthNoise noise = input.is_depth_noise_free ? DepthNoise{} : input.scenario.depth_noise;
    std::vector<RigCamera> cameras;
    for (const rig::Camera& camera : input.rig.cameras)
        cameras.emplace_back(around, camera, noise, noise_seed_of(input.seed, cameras.size()), start);
    return cameras;
}

CameraImage next_image(RigCamera& camera, std::size_t index) {
    const SimTime captured = camera.next();
    return {.camera = index,
            .captured = SimulatedHostClock(kHostAtStart).at(captured),
            .width = camera.camera().width,
            .height = camera.camera().height,
            .depth_mm = camera.take()};
}

/// Runs the rig until `end`, with the images of all cameras. Returns their number.
std::uint64_t run_with_cameras(RigInOneProcess& rig, std::vector<RigCamera>& cameras, SimTime end,
                               const ExperimentOutput& output) {
    std::uint64_t frames = 0;
    while (!cameras.empty()) {
        const auto camera = std::ranges::min_element(cameras, {}, [](const auto& c) { return c.next().us; });
        const SimTime captured = camera->next();
        if (captured >= end) break;
        rig.run_until(captured);
        output.on_depth(next_image(*camera, static_cast<std::size_t>(camera - cameras.begin())));
        ++frames;
        if (output.on_progress)
            output.on_progress(static_cast<double>(captured.us) / static_cast<double>(end.us));
    }
    return frames;
}

Result<ExperimentSummary, Error> run(const ExperimentInput& input, const ExperimentOutput& output) {
    const SimTime start = from_seconds(input.scenario.rest_s);
    const auto trajectory = Trajectory::circle(input.arm, input.scenario.motion, start);
    if (!trajectory) {
        return unexpected(trajectory.error());
    }
    const SimTime end = trajectory->end();

    const WorldAt moving = world_at(input, start);
    RigInOneProcess rig(input, *trajectory, moving, output);
    rig.mark(wire::MarkKind::start, start);
    rig.mark(wire::MarkKind::stop, end);
    const CameraSurroundings around{input.world, input.arm, *trajectory, input.body, moving};
    auto cameras = cameras_of(input, around, start);
    const std::uint64_t frames = run_with_cameras(rig, cameras, end, output);
    rig.run_until({end.us + 500'000});  // delivers the frames still on the bus
    ExperimentSummary summary = rig.summary();
    summary.depth_frames = frames;
    return summary;
}

}  // namespace

Result<ExperimentSummary, Error> run_experiment(const ExperimentInput& input,
                                                const ExperimentOutput& output) {
    try {
        return run(input, output);
    } catch (const BoardLinkError& error) {
        return unexpected(Error{ErrorCode::no_device, error.what()});
    }
}

}  // namespace octoskin::sim
