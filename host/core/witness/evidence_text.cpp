// What the witness found out, in words for a person.
#include <array>
#include <cstdio>
#include <string>

#include "host/core/witness/sensor_witness.hpp"

namespace octoskin {

const char* name(SensorFault fault) {
    switch (fault) {
        case SensorFault::ranges_too_long:
            return "ranges_too_long";
        case SensorFault::ranges_too_short:
            return "ranges_too_short";
        case SensorFault::often_short:
            return "often_short";
        case SensorFault::turned:
            return "turned";
        case SensorFault::exchanged:
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
    }
    return "unknown";
}

const char* name(WitnessVerdict verdict) {
    switch (verdict) {
        case WitnessVerdict::agrees:
            return "agrees";
        case WitnessVerdict::contradicts:
            return "contradicts";
        case WitnessVerdict::cannot_tell:
            return "cannot_tell";
    }
    return "unknown";
}

namespace {

std::string describe_fault(const SensorEvidence& evidence) {
    const std::string offset = ": set its offset (docs/bring-up.md, \"A sensor with a wrong offset\")";
    if (!evidence.fault)
        return "is it swapped with another at the harness, stuck, or its pose in the rig not the true one?";
    switch (*evidence.fault) {
        case SensorFault::ranges_too_long:
            return "its ranges are some centimetres too long" + offset;
        case SensorFault::ranges_too_short:
            return "its ranges are some centimetres too short" + offset + ", if its cover glass is clean";
        case SensorFault::often_short:
            return "some of its ranges end where nothing is: is its cover glass clean?";
        case SensorFault::turned:
            return "it ranges like one turned by some 10 degrees: is its mount bent, or its pose in the rig "
                   "not "
                   "the true one?";
        case SensorFault::exchanged:
            break;
    }
    return "it ranges like sensor " + std::to_string(evidence.exchanged_with.value_or(0)) +
           " of its node: are the two swapped at the harness?";
}

std::string describe_error(const CameraError& error) {
    std::array<char, 96> by{};
    std::snprintf(by.data(), by.size(), "turned by %.1f deg, shifted by %.1f cm, its depth off by %.1f %%",
                  error.turn_deg.norm(), 100.0 * error.shift_m.norm(), 100.0 * (error.depth_scale - 1.0));
    return by.data();
}

std::string describe_error(const JointError& error) {
    std::array<char, 64> by{};
    std::snprintf(by.data(), by.size(), "further by %+.3f rad, or m of a prismatic joint", error.offset);
    return by.data();
}

}  // namespace

/// Ranges that agree are not told: those of a sensor that is 6 cm off do, and more of them come while it is
/// about to be cleared.
std::string describe(const SensorEvidence& evidence) {
    std::string text = "contradicts the camera: " + describe_fault(evidence);
    if (evidence.in_free_space + evidence.behind_surface == 0) return text;
    return text + " (" + std::to_string(evidence.in_free_space) +
           " of its ranges end where the camera sees through, " + std::to_string(evidence.behind_surface) +
           " behind a surface that it sees)";
}

std::string describe(const PoseFault& fault, std::span<const std::string> joints) {
    const std::string explains =
        ": that explains what " + std::to_string(fault.explained) + " sensors contradict (by an estimate ";
    const std::string see = " (docs/method.md, \"A sensor that contradicts the camera\")";
    if (!fault.joint)
        return "camera: not where the rig has it, or its scale is off" + explains +
               describe_error(*fault.camera) + "): measure the camera's pose anew" + see;
    const std::string joint = "joint " + joints[fault.joint->joint];
    if (!fault.camera)
        return joint + ": not where its joint states say" + explains + describe_error(*fault.joint) +
               "): compare the arm's posture with its joint states, and set the joint's zero anew" + see;
    return "camera or " + joint + ": one of them is not where it is said to be; which of them is not known" +
           explains + describe_error(*fault.joint) + ", or the camera " + describe_error(*fault.camera) +
           "). Compare the arm's posture with its joint states first; else measure the camera's pose anew" +
           see;
}

}  // namespace octoskin
