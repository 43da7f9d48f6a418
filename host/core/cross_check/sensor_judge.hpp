// Sequential tests of range sensors against the camera's predictions. Decide whether a sensor ranges as
// mounted in the rig, or has an offset, is turned, is exchanged with another, or is occasionally short; and
// whether one error of the camera, or of a joint, explains as much.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/core/beams/beam.hpp"
#include "host/core/cross_check/fault_sum.hpp"
#include "host/core/cross_check/pose_judge.hpp"
#include "host/core/cross_check/range_predictor.hpp"
#include "host/core/cross_check/thickness_memory.hpp"

namespace octoskin {

enum class RangeFault : std::uint8_t {
    ranges_too_long,   ///< by several centimetres
    ranges_too_short,  ///< by several centimetres
    often_short,       ///< some of its ranges end in free space
    turned,            ///< its mount is turned by about 10 degrees
    exchanged,         ///< exchanged with another sensor of its node
};

inline constexpr std::size_t kRangeFaults = 5;

/// Why a sensor can neither be reported nor be said to agree.
enum class SensorDoubt : std::uint8_t {
    too_few_comparisons,  ///< one of the faults would not have shown yet
    ambiguous,            ///< a fault has neither enough evidence for it nor enough against it
    camera_not_known,     ///< the other sensors do not determine the camera's pose well enough
    camera_is_off,        ///< an error of the camera is reported, or likely
    several_contradict,   ///< more than two sensors contradict the camera
    joint_is_off,         ///< an offset of a joint is reported (alone or beside the camera), or likely
    cameras_disagree,     ///< it contradicts one camera and agrees with another
};

/// One range with the camera's predictions at its time.
struct Compared {
    std::uint16_t sensor = 0;  ///< index in the rig, node by node
    Beam beam;                 ///< has a range
    RangePredictions predictions;
    JointTwists twists_camera = {};  ///< motion of the sensor with each joint, camera coordinates
};

class SensorJudge {
  public:
    /// `sensors_of_nodes`: number of sensors of each node.
    /// `joints`: of the robot.
    SensorJudge(std::span<const std::size_t> sensors_of_nodes, std::size_t joints);

    /// Evaluates all comparisons with one image, at most one range a sensor. 0.3 ms for 34.
    void judge(std::span<const Compared> compared);
    /// Reports the result of another test: a sensor found there counts as contradicting.
    void set_far_off(std::uint16_t sensor, bool is_far_off) { sensors_[sensor].is_far_off = is_far_off; }

    /// Why a contradicting sensor may not be reported; empty: it may. It may not while the camera or a joint
    /// may be the cause: because its error explains the contradictions of several sensors, or to a small part
    /// those of this and others, or because more than two sensors contradict at once.
    [[nodiscard]] std::optional<SensorDoubt> against_naming(std::uint16_t sensor,
                                                            const Eigen::Vector3d& p_camera,
                                                            double misplaced_max_m) const;
    [[nodiscard]] const PoseJudge& pose() const noexcept { return pose_; }

    /// Without fault and doubt, the sensor agrees: every fault that would have changed its ranges is
    /// excluded.
    struct SensorFinding {
        std::optional<RangeFault> fault;
        std::optional<std::uint8_t> exchanged_with;  ///< local index on its node
        std::optional<SensorDoubt> doubt = SensorDoubt::too_few_comparisons;
        std::bitset<kRangeFaults> not_excluded = (1U << kRangeFaults) - 1U;  ///< by RangeFault
        std::uint64_t agreed = 0;    ///< comparisons with a surface that fit the rig
        std::uint64_t compared = 0;  ///< all comparisons with a surface
        double evidence = 0.0;       ///< for the most likely fault: log-likelihood ratio to a healthy sensor
    };
    [[nodiscard]] const SensorFinding& verdict(std::uint16_t sensor) const {
        return sensors_[sensor].verdict;
    }

    /// Evidence from which a fault is reported.
    static constexpr double kNamedFrom = 12.0;
    /// Evidence against a reported fault from which it is withdrawn.
    static constexpr double kTakenBackFrom = 10.0;
    /// An exchange needs more: it is the best of as many hypotheses as the node has sensors.
    static constexpr double kExchangedFrom = 16.0;
    /// Evidence from which a sensor counts as contradicting.
    static constexpr double kContradictsFrom = 8.0;

  private:
    static constexpr std::size_t kFaults = 3 + kTurns;
    enum class Saw : std::uint8_t { nothing, agrees, is_short };
    /// What a sensor saw beside one image.
    struct Look {
        Saw saw = Saw::nothing;
        std::uint8_t zone = 0;
        friend bool operator==(const Look&, const Look&) = default;
    };
    struct Sensor {
        std::size_t node_begin = 0;  ///< index of the node's first sensor
        std::array<FaultSum, kFaults> faults{};
        std::vector<FaultSum> exchanged;                      ///< by sensor of the node
        const FaultSum* named = nullptr;                      ///< the reported one of those
        HostTime now{};                                       ///< time of the current comparison
        Eigen::Vector3d p_camera = Eigen::Vector3d::UnitZ();  ///< where it last measured
        bool is_far_off = false;                              ///< by another test
        double misfit_mean = 0.0;                             ///< of the newest ranges, relative to the rig
        std::array<Look, 2> looks{};                          ///< of the two images before, the newest first
        SensorFinding verdict;
    };
    /// The range by a hypothesis.
    struct Expected {
        RangePrediction at;
        bool has_lower_bound = false;  ///< false: any shorter range is as likely
        double sigma_m = 0.0;
    };

    [[nodiscard]] Expected expected(const Compared& compared, const RangePrediction& prediction) const;
    [[nodiscard]] static std::optional<double> misfit(const Expected& expected, double range_m,
                                                      double sigma_m);
    [[nodiscard]] static double sigma_of(const Compared& compared, const Expected& a, const Expected& b);
    template <typename Misfit>
    static void weigh_fault(FaultSum& sum, const Compared& compared, const Expected& mounted, double sigma_m,
                            const Misfit& misfit_with_fault);
    void weigh(const Compared& compared, const Expected& mounted);
    void weigh_short(Sensor& sensor, const Compared& compared, const Expected& mounted,
                     double misfit_mounted);
    void weigh_exchange(const Compared& of, const Expected& own, const Compared& other,
                        const Expected& others);
    void ask_pose(const Compared& compared);
    [[nodiscard]] SensorDoubt doubt_of_pose() const;
    [[nodiscard]] bool contradicts(const Sensor& sensor) const;
    [[nodiscard]] bool is_convincing(const Sensor& sensor, const FaultSum& sum) const;
    [[nodiscard]] std::optional<SensorDoubt> doubt_of(Sensor& sensor) const;
    void decide(std::uint16_t number);
    void remember(const Compared& compared);

    std::vector<Sensor> sensors_;
    std::vector<Look> looks_;  ///< of the current image
    ThicknessMemory thickness_;
    PoseJudge pose_;
};

}  // namespace octoskin
