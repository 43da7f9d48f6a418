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

std::string describe(const CameraError& error, std::size_t sensors) {
    std::array<char, 96> by{};
    std::snprintf(by.data(), by.size(), "turned by %.1f deg, shifted by %.1f cm, its depth off by %.1f %%",
                  error.turn_deg.norm(), 100.0 * error.shift_m.norm(), 100.0 * (error.depth_scale - 1.0));
    return "not where the rig has it, or its scale is off: that explains what " + std::to_string(sensors) +
           " sensors contradict (by an estimate " + by.data() +
           "). Compare the arm's posture with its joint states first, as a joint whose zero is off looks the "
           "same; else measure the camera's pose anew (docs/method.md, \"A sensor that contradicts the "
           "camera\")";
}

}  // namespace octoskin
