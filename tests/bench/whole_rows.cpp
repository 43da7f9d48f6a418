#include "tests/bench/whole_rows.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "host/core/pipeline/depth_stage.hpp"
#include "tests/bench/arm_capsules.hpp"
#include "tests/bench/clouds.hpp"
#include "tests/bench/depth_steps.hpp"
#include "tests/bench/frame_task.hpp"
#include "tests/bench/peer_rows.hpp"
#include "tests/bench/sizes.hpp"

namespace octoskin::bench {
namespace {

struct Method {
    const char* name;
    DepthUpdate update;
};
constexpr std::array kMethods = {
    Method{.name = "whole_denoised", .update = DepthUpdate::denoised},
    Method{.name = "whole_fast", .update = DepthUpdate::fast},
    Method{.name = "whole_paper", .update = DepthUpdate::paper},
};

constexpr std::int64_t kPeriod_ns = 100'000'000;

/// The camera measures all that a frame can hold, as OctoMap's cloud has it all.
HostRig rig_of(const RoomFrames& room) {
    HostRig rig;
    rig.cameras = {HostCamera{.intrinsics = room.camera,
                              .depth_min_m = 0.001,
                              .depth_max_m = 65.535,
                              .T_link_camera = room.frames.front().T_map_camera}};
    return rig;
}

DepthFrame captured(const RoomFrame& frame, bool is_stationary, HostTime time) {
    DepthFrame captured{
        .captured = time, .width = frame.image.width, .height = frame.image.height, .depth_mm = {}};
    if (!is_stationary) captured.T_map_camera = frame.T_map_camera;
    for (const float depth_m : frame.image.depth_m) {
        captured.depth_mm.push_back(std::isnan(depth_m)
                                        ? std::uint16_t{0}
                                        : static_cast<std::uint16_t>(std::lround(1000.0F * depth_m)));
    }
    return captured;
}

/// An arm moves in the middle of each picture. It hides nothing, but all pixels behind it are tested.
class WholeFrames final : public FrameTask {
  public:
    WholeFrames(const RoomFrames& room, const std::string& resolution, DepthUpdate update)
        : FrameTask(room),
          config_(bench_mapping(resolution, update)),
          rig_(rig_of(room)),
          stage_(rig_, config_),
          map_(config_.map),
          steps_(rig_, config_),
          arm_camera_(postures_of_arm(OCTOSKIN_RIG, arm_before_camera())) {}

    void prepare() override {
        // Of the frame before, so that nothing of the next one is in a cache yet.
        if (frames_ > 0) take_steps();
        const RoomFrame& frame = next();
        frame_ = captured(frame, room().is_stationary, HostTime{frames_ * kPeriod_ns});
        robot_.body_base = arm_camera_[static_cast<std::size_t>(frames_) % arm_camera_.size()];
        for (PosedCapsule& capsule : robot_.body_base) {
            capsule.p_a = frame.T_map_camera * capsule.p_a;
            capsule.p_b = frame.T_map_camera * capsule.p_b;
        }
        ++frames_;
    }
    void run() override {
        const auto updates = stage_.updates(frame_, &robot_);
        if (!updates) throw std::runtime_error("a frame was refused");
        stage_.keep(frame_);
        map_.advance_time(frame_.captured);
        if (!updates->retracted.empty()) map_.apply(updates->retracted);
        map_.apply(updates->terms);
    }
    void tell(Figures& figures) const override {
        if (map_.counters().no_room + map_.counters().no_memory > 0)
            throw std::runtime_error("a map is full");
        tell_size(map_, figures);
        figures.parts_ms = steps_.times_ms();
    }

  private:
    void take_steps() {
        steps_.take(frame_, robot_);
        if (steps_.map().known_voxels() != map_.known_voxels())
            throw std::runtime_error("the steps one by one make another map than the stage");
    }

    MappingConfig config_;
    HostRig rig_;
    DepthStage stage_;
    FusedMap map_;
    DepthSteps steps_;
    std::vector<ArmCapsules> arm_camera_;
    std::int64_t frames_ = 0;
    DepthFrame frame_;
    RobotPose robot_;
};

}  // namespace

std::vector<Row> whole_rows(const RoomFrames& room, const std::string& resolution, unsigned runs,
                            const std::string& suffix) {
    std::vector<Row> rows;
    for (const Method& method : kMethods) {
        rows.push_back({method.name + suffix, kOctomap + suffix, runs, [&room, resolution, method] {
                            return std::make_unique<WholeFrames>(room, resolution, method.update);
                        }});
    }
    return rows;
}

}  // namespace octoskin::bench
