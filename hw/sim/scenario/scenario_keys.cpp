#include "hw/sim/scenario/scenario_keys.hpp"

#include <array>

namespace octoskin::sim {
namespace keys {
namespace {

using rig::AnyKey;

constexpr auto kTopKeys = std::to_array<AnyKey>(
    {&kName, &kWorld, &kWorldMotionFile, &kMotionTable, &kDepthTable, &kRangesTable, &kSlowClocksTable,
     &kSensorTraitsList, &kSeedsTable, &kHiddenModels, &kRegionTable});
constexpr auto kMotionKeys = std::to_array<AnyKey>({&motion::kRest, &motion::kCircle});
constexpr auto kDepthKeys = std::to_array<AnyKey>({&depth::kNoise, &depth::kSigma, &depth::kKinectTable});
constexpr auto kKinectKeys = std::to_array<AnyKey>(
    {&kinect::kSigmaMin, &kinect::kSigmaMinAt, &kinect::kSigmaGrowth, &kinect::kBiasGrowth,
     &kinect::kBiasSpacing, &kinect::kDisparityStep, &kinect::kBaseline, &kinect::kFocal, &kinect::kEdgeStep,
     &kinect::kFlyingShare, &kinect::kMissingShare});
constexpr auto kRangesKeys =
    std::to_array<AnyKey>({&ranges::kSigma, &ranges::kMin, &ranges::kMax, &ranges::kReflectivity});
constexpr auto kSlowClocksKeys = std::to_array<AnyKey>({&slow_clocks::kFactorMin, &slow_clocks::kFactorMax});
constexpr auto kSeedsKeys = std::to_array<AnyKey>({&seeds::kMapShift, &seeds::kFurtherMapShiftMax});
constexpr auto kRegionKeys = std::to_array<AnyKey>({&region::kMin, &region::kMax, &region::kFloorTop});
constexpr auto kTraitsKeys =
    std::to_array<AnyKey>({&traits::kNodeId, &traits::kSensor, &traits::kRegister, &traits::kReads,
                           &traits::kMask, &traits::kRangeSpread, &traits::kRangeStep, &traits::kBootLoad});
constexpr auto kCircleKeys = std::to_array<AnyKey>(
    {&circle::kLink, &circle::kCentre, &circle::kRadius, &circle::kTowardsStart, &circle::kTowardsQuarter,
     &circle::kTicksPerRevolution, &circle::kTickRate, &circle::kRevolutions, &circle::kStartPosition});
constexpr auto kWorldMotionKeys = std::to_array<AnyKey>({&world_motion::kModels});
constexpr auto kModelKeys = std::to_array<AnyKey>({&world_motion::kModel, &world_motion::kPlaces});
constexpr auto kPlaceKeys = std::to_array<AnyKey>(
    {&world_motion::kAt, &world_motion::kIsThere, &world_motion::kOffset, &world_motion::kMovesOn});

constexpr std::string_view kScenario = "scenario keys";
constexpr std::string_view kMotionFile = "scenario keys of a world_motion";

}  // namespace

constinit const rig::KeyTable kTop{kScenario, kTopKeys};
constinit const rig::KeyTable kMotion{kScenario, kMotionKeys};
constinit const rig::KeyTable kDepth{kScenario, kDepthKeys};
constinit const rig::KeyTable kKinect{"scenario keys of depth.kinect", kKinectKeys};
constinit const rig::KeyTable kRanges{kScenario, kRangesKeys};
constinit const rig::KeyTable kSlowClocks{kScenario, kSlowClocksKeys};
constinit const rig::KeyTable kSeeds{kScenario, kSeedsKeys};
constinit const rig::KeyTable kRegion{kScenario, kRegionKeys};
constinit const rig::KeyTable kSensorTraits{"scenario keys of sensor_traits", kTraitsKeys};
constinit const rig::KeyTable kCircle{"scenario keys of motion.circle", kCircleKeys};
constinit const rig::KeyTable kWorldMotion{kMotionFile, kWorldMotionKeys};
constinit const rig::KeyTable kModel{kMotionFile, kModelKeys};
constinit const rig::KeyTable kPlace{kMotionFile, kPlaceKeys};

}  // namespace keys

std::span<const rig::KeyTable> scenario_key_tables() noexcept {
    static const std::array kTables{keys::kTop,        keys::kMotion, keys::kDepth,       keys::kRanges,
                                    keys::kSlowClocks, keys::kSeeds,  keys::kRegion,      keys::kSensorTraits,
                                    keys::kKinect,     keys::kCircle, keys::kWorldMotion, keys::kModel,
                                    keys::kPlace};
    return kTables;
}

}  // namespace octoskin::sim
