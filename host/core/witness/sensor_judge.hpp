// Sequential tests of range sensors against what the camera predicts of them: whether each ranges as the rig
// has it, or as one that is off, turned, exchanged with another, or short every now and then; or whether one
// error of the camera, or of a joint, explains as much.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/core/beams/beam.hpp"
#include "host/core/witness/fault_sum.hpp"
#include "host/core/witness/pose_judge.hpp"
#include "host/core/witness/range_predictor.hpp"
#include "host/core/witness/thickness_memory.hpp"

namespace octoskin {

enum class SensorFault : std::uint8_t {
    ranges_too_long,   ///< by several centimetres
    ranges_too_short,  ///< the same
    often_short,       ///< one range of a few ends where there is nothing
    turned,            ///< its mount, by about 10 degrees
    exchanged,         ///< with another of its node
};

inline constexpr std::size_t kSensorFaults = 5;

/// Why a sensor can neither be named nor be said to agree.
enum class SensorDoubt : std::uint8_t {
    too_few_comparisons,  ///< one of its faults would not have shown yet
    ambiguous,            ///< a fault has neither enough evidence for it nor enough against it
    camera_not_known,     ///< the other sensors do not show well enough where the camera is
    camera_is_off,        ///< an error of the camera is named, or likely
    several_contradict,   ///< more than two sensors do
    joint_is_off,         ///< an offset of a joint is named, alone or beside the camera, or likely
};

/// One range and what the camera predicts at its time.
struct Compared {
    std::uint16_t sensor = 0;  ///< by its place in the rig, node by node
    Beam beam;                 ///< with a range
    RangePredictions predictions;
    JointTwists twists_camera = {};  ///< how the sensor moves with each joint, camera coordinates
};

class SensorJudge {
  public:
    /// `sensors_of_nodes`: how many each node has.
    explicit SensorJudge(std::span<const std::size_t> sensors_of_nodes);

    /// All that is compared with one image, at most one range a sensor. 0.3 ms for 34.
    void judge(std::span<const Compared> compared);
    /// What another test has found of a sensor counts as its contradicting.
    void set_far_off(std::uint16_t sensor, bool is_far_off) { sensors_[sensor].is_far_off = is_far_off; }

    /// Why a sensor that contradicts may not be named, if so. Not while the camera or a joint may be what is
    /// off: because an error of it explains what several sensors contradict, or this one and others a little;
    /// or because more than two sensors contradict at once.
    [[nodiscard]] std::optional<SensorDoubt> against_naming(std::uint16_t sensor,
                                                            const Eigen::Vector3d& p_camera,
                                                            double misplaced_max_m) const;
    [[nodiscard]] const PoseJudge& pose() const noexcept { return pose_; }

    /// With neither fault nor doubt the sensor agrees: no fault that would have changed its ranges is left.
    struct Verdict {
        std::optional<SensorFault> fault;
        std::optional<std::uint8_t> exchanged_with;  ///< local index on its node
        std::optional<SensorDoubt> doubt = SensorDoubt::too_few_comparisons;
        std::bitset<kSensorFaults> not_excluded = (1U << kSensorFaults) - 1U;  ///< by SensorFault
        std::uint64_t agreed = 0;    ///< comparisons with a surface that fit what the rig says
        std::uint64_t compared = 0;  ///< and all of them
        double evidence = 0.0;       ///< for the likeliest fault: log-likelihood ratio to a sound sensor
    };
    [[nodiscard]] const Verdict& verdict(std::uint16_t sensor) const { return sensors_[sensor].verdict; }

    /// With so much evidence a fault is named.
    static constexpr double kNamedFrom = 12.0;
    /// With so much against it, it is no more.
    static constexpr double kTakenBackFrom = 10.0;
    /// An exchange takes more: it is the best of as many guesses as the node has sensors.
    static constexpr double kExchangedFrom = 16.0;
    /// With so much it counts as contradicting.
    static constexpr double kContradictsFrom = 8.0;

  private:
    static constexpr std::size_t kFaults = 3 + kTurns;
    enum class Look : std::uint8_t { nothing, agrees, is_short };
    struct Sensor {
        std::size_t node_begin = 0;  ///< the node's sensors are numbered from here
        std::array<FaultSum, kFaults> faults{};
        std::vector<FaultSum> exchanged;                      ///< by sensor of the node
        const FaultSum* named = nullptr;                      ///< of those
        HostTime now{};                                       ///< of what is weighed
        Eigen::Vector3d p_camera = Eigen::Vector3d::UnitZ();  ///< where it ranged last
        bool is_far_off = false;                              ///< by another test
        double misfit_mean = 0.0;                             ///< of the newest ranges, to what the rig says
        std::array<Look, 2> looks{};                          ///< of the two images before, the newest first
        Verdict verdict;
    };
    /// Where a hypothesis has the range.
    struct Expected {
        RangePrediction at;
        bool has_lower_bound = false;  ///< else anything nearer is as likely
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
    std::vector<Look> looks_;  ///< of the image that is judged
    ThicknessMemory thickness_;
    PoseJudge pose_;
};

}  // namespace octoskin
