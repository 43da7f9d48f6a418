// Results of the cross-check as text for people.
#include <array>
#include <cstdio>
#include <string>

#include "host/core/cross_check/cross_check.hpp"
#include "host/core/rig/camera_text.hpp"

namespace octoskin {

const char* name(RangeFault fault) {
    switch (fault) {
        case RangeFault::ranges_too_long:
            return "ranges_too_long";
        case RangeFault::ranges_too_short:
            return "ranges_too_short";
        case RangeFault::often_short:
            return "often_short";
        case RangeFault::turned:
            return "turned";
        case RangeFault::exchanged:
            return "exchanged";
    }
    return "unknown";
}

const char* name(SensorDoubt doubt) {
    switch (doubt) {
        case SensorDoubt::too_few_comparisons:
            return "too_few_comparisons";
        case SensorDoubt::ambiguous:
            return "ambiguous";
        case SensorDoubt::camera_not_known:
            return "camera_not_known";
        case SensorDoubt::camera_is_off:
            return "camera_is_off";
        case SensorDoubt::several_contradict:
            return "several_contradict";
        case SensorDoubt::joint_is_off:
            return "joint_is_off";
        case SensorDoubt::cameras_disagree:
            return "cameras_disagree";
    }
    return "unknown";
}

const char* name(CrossCheckFinding verdict) {
    switch (verdict) {
        case CrossCheckFinding::agrees:
            return "agrees";
        case CrossCheckFinding::contradicts:
            return "contradicts";
        case CrossCheckFinding::cannot_tell:
            return "cannot_tell";
    }
    return "unknown";
}

namespace {

std::string describe_fault(const SensorEvidence& evidence) {
    const std::string offset = ": set its offset (docs/hardware/calibration.md)";
    if (!evidence.fault)
        return "it may be swapped with another at the harness, be stuck, or have a wrong pose in the rig";
    switch (*evidence.fault) {
        case RangeFault::ranges_too_long:
            return "its ranges are some centimetres too long" + offset;
        case RangeFault::ranges_too_short:
            return "its ranges are some centimetres too short" + offset + ", if its cover glass is clean";
        case RangeFault::often_short:
            return "some of its ranges end in free space: clean its cover glass";
        case RangeFault::turned:
            return "its ranges fit a sensor turned by about 10 degrees: check its mount and its pose in the "
                   "rig";
        case RangeFault::exchanged:
            break;
    }
    return "its ranges fit sensor " + std::to_string(evidence.exchanged_with.value_or(0)) +
           " of its node: check whether the two are swapped at the harness";
}

std::string describe_error(const CameraError& error) {
    std::array<char, 96> by{};
    std::snprintf(by.data(), by.size(), "turned by %.1f deg, shifted by %.1f cm, its depth off by %.1f %%",
                  error.turn_deg.norm(), 100.0 * error.shift_m.norm(), 100.0 * (error.depth_scale - 1.0));
    return by.data();
}

std::string describe_error(const JointError& error) {
    std::array<char, 64> by{};
    std::snprintf(by.data(), by.size(), "offset by %+.3f rad, or m of a prismatic joint", error.offset);
    return by.data();
}

}  // namespace

/// Ranges that agree are not listed: a sensor with an offset of 6 cm has many of them, also shortly before it
/// is cleared.
std::string describe(const SensorEvidence& evidence, std::string_view camera) {
    std::string text = "contradicts the " + camera_text(camera) + ": " + describe_fault(evidence);
    if (evidence.in_free_space + evidence.behind_surface == 0) return text;
    return text + " (" + std::to_string(evidence.in_free_space) +
           " of its ranges end where the camera sees free space, " + std::to_string(evidence.behind_surface) +
           " behind a surface)";
}

std::string describe(const PoseFault& fault, std::span<const std::string> joints, std::string_view camera) {
    const std::string named = camera_text(camera);
    const std::string explains =
        ": that explains the contradictions of " + std::to_string(fault.explained) + " sensors (estimate: ";
    const std::string see = " (docs/concepts/cross-check.md)";
    const std::string exchanged =
        camera.empty() ? "" : ", unless its device is that of another camera of the rig";
    if (!fault.joint)
        return named + ": its pose in the rig or its depth scale is wrong" + explains +
               describe_error(*fault.camera) + "): measure the camera's pose again" + exchanged + see;
    const std::string joint = "joint " + joints[fault.joint->joint];
    if (!fault.camera)
        return joint + ": its position differs from its joint states" + explains +
               describe_error(*fault.joint) +
               "): compare the arm's posture with its joint states, and set the joint's zero again" + see;
    return named + " or " + joint + ": one of them has a wrong pose; which one is not known" + explains +
           describe_error(*fault.joint) + ", or the camera " + describe_error(*fault.camera) +
           "). Compare the arm's posture with its joint states first; otherwise measure the camera's pose "
           "again" +
           exchanged + see;
}

}  // namespace octoskin
