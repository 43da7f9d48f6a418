#include "hw/rigfile/rig_keys.hpp"

namespace octoskin::rig {
namespace keys {
namespace {

constexpr auto kTopKeys = std::to_array<AnyKey>(
    {&kName, &kRobotTable, &kMapBase, &kBusTable, &kRangeLimitsTable, &kJointsTable, &kCameraTable, &kCameras,
     &kSensorDefaults, &kNodes,
     &kExtends});  // already removed when the keys are checked; for the hint about an unknown key
constexpr auto kRobotKeys = std::to_array<AnyKey>({&robot::kUrdf, &robot::kBaseLink, &robot::kLinkPadding,
                                                   &robot::kFitsCapsules, &robot::kAttachedCapsules,
                                                   &robot::kLinksWithoutBody, &robot::kLinksIgnoredBySensors,
                                                   &robot::kDepthSelfMargin, &robot::kRangeSelfMargin});
constexpr auto kCapsuleKeys = std::to_array<AnyKey>({&capsule::kName, &capsule::kLink, &capsule::kFrom,
                                                     &capsule::kTo, &capsule::kRadius, &capsule::kPadding});
constexpr auto kPoseKeys = std::to_array<AnyKey>(
    {&pose::kPosition, &pose::kRollPitchYaw, &pose::kQuaternion, &pose::kRotationRows, &pose::kLookingAt});
constexpr auto kBusKeys = std::to_array<AnyKey>({&bus::kProtocol, &bus::kNominalBitrate, &bus::kDataBitrate});
constexpr auto kRangeLimitsKeys = std::to_array<AnyKey>(
    {&range_limits::kMin, &range_limits::kMax, &range_limits::kSigmaMax, &range_limits::kTimeUncertaintyMax});
constexpr auto kJointsKeys =
    std::to_array<AnyKey>({&joints::kNodeId, &joints::kNames, &joints::kRate, &joints::kWay});
constexpr auto kCameraKeys = std::to_array<AnyKey>(
    {&camera::kName, &camera::kDevice, &camera::kWidth, &camera::kHeight, &camera::kFx, &camera::kFy,
     &camera::kCx, &camera::kCy, &camera::kDistortion, &camera::kRate, &camera::kDepthMin, &camera::kDepthMax,
     &camera::kNoise, &camera::kDataSet, &camera::kLink, &camera::kPose});
constexpr auto kCameraNoiseKeys =
    std::to_array<AnyKey>({&noise::kNoise, &noise::kNoisePer, &noise::kNoiseFrom, &noise::kBiasPer});
constexpr auto kDataSetKeys =
    std::to_array<AnyKey>({&data_set::kDepthUnits, &data_set::kDepthNoValue, &data_set::kPoseGapMax});
constexpr auto kDistortionKeys = std::to_array<AnyKey>(
    {&distortion::kK1, &distortion::kK2, &distortion::kP1, &distortion::kP2, &distortion::kK3});
constexpr auto kNodeKeys = std::to_array<AnyKey>(
    {&node::kName, &node::kNodeId, &node::kBoard, &node::kI2cHz, &node::kIoLevel, &node::kReadsTwice,
     &node::kStreamGate, &node::kAuxEvery, &node::kZoneGuard, &node::kHoldsPhases, &node::kDataReadyBuses,
     &node::kReadyJitter, &node::kVerification, &node::kRefusesCommands, &node::kPinnedBuildId,
     &node::kSensors});
constexpr auto kVerificationKeys = std::to_array<AnyKey>({&verification::kEnabled, &verification::kLeaveOut});
constexpr auto kSensorKeys = std::to_array<AnyKey>(
    {&sensor::kName, &sensor::kLink, &sensor::kPose, &sensor::kBus, &sensor::kXshutLine, &sensor::kAddress,
     &sensor::kDistanceMode, &sensor::kTimingBudget, &sensor::kInterMeasurement, &sensor::kPhase,
     &sensor::kDeviceOffset, &sensor::kCrosstalk, &sensor::kSigmaLimit, &sensor::kSignalLimit,
     &sensor::kReflexBelow, &sensor::kAppliesGainFactor, &sensor::kZones, &sensor::kCone});
constexpr auto kZoneKeys =
    std::to_array<AnyKey>({&zone::kCentre, &zone::kWidth, &zone::kHeight, &zone::kOffset});
constexpr auto kConeKeys =
    std::to_array<AnyKey>({&cone::kSubRays, &cone::kHalfAngle, &cone::kSigma, &cone::kBlur});
constexpr auto kBoardKeys = std::to_array<AnyKey>(
    {&board::kName, &board::kBoardType, &board::kI2cBusCount, &board::kXshutLineCount, &board::kSensorsMax,
     &board::kSensorsPerBusMax, &board::kSupportsCanFd, &board::kHasDataReadyLines});

}  // namespace

constinit const KeyTable kTop{"rig keys of the top level", kTopKeys};
constinit const KeyTable kRobot{"rig keys of robot", kRobotKeys};
constinit const KeyTable kAttachedCapsule{"rig keys of an attached capsule", kCapsuleKeys};
constinit const KeyTable kPose{"rig keys of a sensor's pose",
                               std::span(kPoseKeys).first<kPoseKeys.size() - 1>()};
constinit const KeyTable kCameraPose{"rig keys of a pose", kPoseKeys};
constinit const KeyTable kBus{"rig keys of bus", kBusKeys};
constinit const KeyTable kRangeLimits{"rig keys of range_limits", kRangeLimitsKeys};
constinit const KeyTable kJoints{"rig keys of joints", kJointsKeys};
constinit const KeyTable kCamera{"rig keys of camera", kCameraKeys};
constinit const KeyTable kCameraNoise{"rig keys of camera.noise", kCameraNoiseKeys};
constinit const KeyTable kDataSet{"rig keys of camera.data_set", kDataSetKeys};
constinit const KeyTable kDistortion{"rig keys of camera.distortion", kDistortionKeys};
constinit const KeyTable kNode{"rig keys of a node", kNodeKeys};
constinit const KeyTable kVerification{"rig keys of verification", kVerificationKeys};
constinit const KeyTable kSensor{"rig keys of a sensor", kSensorKeys};
constinit const KeyTable kZone{"rig keys of a zone", kZoneKeys};
constinit const KeyTable kCone{"rig keys of cone", kConeKeys};
constinit const KeyTable kBoard{"rig keys of a board", kBoardKeys};

}  // namespace keys

std::span<const KeyTable> rig_key_tables() noexcept {
    static const std::array kTables{
        keys::kTop,         keys::kRobot,  keys::kAttachedCapsule, keys::kCameraPose,  keys::kBus,
        keys::kRangeLimits, keys::kJoints, keys::kCamera,          keys::kCameraNoise, keys::kDataSet,
        keys::kDistortion,  keys::kNode,   keys::kVerification,    keys::kSensor,      keys::kZone,
        keys::kCone,        keys::kBoard};
    return kTables;
}

}  // namespace octoskin::rig
