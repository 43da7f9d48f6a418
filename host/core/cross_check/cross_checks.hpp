// The cross-checks of the range sensors against each depth camera of a rig.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/core/cross_check/cross_check.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

class CrossChecks {
  public:
    /// `configs`: of each camera of the rig, at least one (asserted).
    CrossChecks(const HostRig& rig, std::span<const CrossCheckConfig> configs);

    [[nodiscard]] std::size_t cameras() const noexcept { return checks_.size(); }
    [[nodiscard]] CrossCheck& of(std::size_t camera) { return checks_.at(camera); }
    [[nodiscard]] const CrossCheck& of(std::size_t camera) const { return checks_.at(camera); }

    /// Time jump: CrossCheck::forget_beams.
    void forget_beams();

    /// The evidence of one camera about a sensor.
    struct SensorFinding {
        SensorEvidence evidence;
        std::size_t camera = 0;
    };
    /// Of the camera with the strongest evidence: one that the sensor contradicts comes before one that it
    /// agrees with, and that before the others. If it contradicts one and agrees with another, either camera
    /// may be the cause: nothing is reported (SensorDoubt::cameras_disagree). `by_camera`: at least one
    /// (asserted). O(cameras).
    [[nodiscard]] static SensorFinding merged(std::span<const SensorEvidence> by_camera);
    /// The merged evidence about a sensor of the rig (asserted). Nothing is reported while an error of a
    /// joint is likely by another camera: the sensors below that joint are off for all of them.
    [[nodiscard]] SensorFinding finding(std::uint8_t node_id, std::uint8_t sensor) const;

    /// The error of a camera or of a joint by one camera. If another camera finds an error of a joint, that
    /// joint may be the cause here, too: then both are set.
    [[nodiscard]] std::optional<PoseFault> pose_fault(std::size_t camera) const;

    /// CrossCheck::is_to_be_refused for the camera of that finding, if it contradicts.
    [[nodiscard]] bool is_to_be_refused(std::uint8_t node_id, std::uint8_t sensor) const;

  private:
    [[nodiscard]] bool is_joint_suspect_by_another(std::size_t camera) const;

    std::vector<CrossCheck> checks_;
};

}  // namespace octoskin
