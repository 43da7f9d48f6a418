// Checks whether the arm can have moved from one joint sample to the next in the time between. It detects two
// programs that send joint states under the same identifier, when nothing else separates them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/time.hpp"
#include "host/core/kinematics/joint_history.hpp"
#include "host/core/kinematics/robot_model.hpp"

namespace octoskin {

struct JointJumpConfig {
    /// Factor on the joint's velocity limit: drivers round, and controllers overshoot.
    double velocity_margin = 1.5;
    /// Error of the two times together. A sample without its own time has that of its arrival, and samples
    /// sent every 10 ms may arrive in bursts every 20 ms.
    Nanoseconds time_uncertainty{20'000'000};
    /// Radians or metres. Covers sources that send text with two decimals.
    double resolution = 0.01;
    /// After this silence a sender no longer counts as active.
    Nanoseconds heard_for{1'000'000'000};
};

/// A sample that is too far from the sample before it.
struct JointJumped {
    std::size_t joint = 0;  ///< the joint that exceeds its limit the most
    double from = 0.0;      ///< radians or metres
    double to = 0.0;
    double step_max = 0.0;  ///< the joint's allowed movement in that time
    Nanoseconds passed{0};
    HostTime sampled;
};

/// Follows two tracks: the used track and the newest one that is too far from it. A single sample that jumps
/// is rejected alone. After two jumps within a second there are two senders: neither is used until no sample
/// has jumped for a second, or until the used track has been silent for a second. So a wrong first sample
/// costs one second, and no track is excluded permanently.
class JointJump {
  public:
    /// `limits`: one per joint, at most kSourceJointsMax, each with a velocity above 0 (asserted).
    explicit JointJump(std::span<const JointLimits> limits, const JointJumpConfig& config = {});

    enum class SampleFit : std::uint8_t {
        fits,
        jumped,    ///< the sample is too far from the used track
        withheld,  ///< it is on the used track, but another track is active
    };
    /// Takes samples in the order of their times; the history rejects one that is not later than the newest.
    /// `position` has one finite value per joint (asserted). `clock` identifies the clock of the times: times
    /// of two clocks are not comparable, so a new clock resets the state. O(1), no allocation.
    [[nodiscard]] SampleFit judge(HostTime sampled, std::span<const double> position,
                                  std::uint64_t clock = 0);

    /// Clears all samples.
    void forget() noexcept;

    /// The newest sample that jumped; empty if none did.
    [[nodiscard]] const std::optional<JointJumped>& newest() const noexcept { return newest_; }

  private:
    struct Point {
        HostTime sampled;
        std::array<double, kSourceJointsMax> position{};
    };
    /// The largest movement of a joint between two points, as a multiple of the allowed movement; and that
    /// joint.
    struct Distance {
        double excess = 0.0;
        std::size_t joint = 0;
    };
    [[nodiscard]] double step_max(std::size_t joint, Nanoseconds passed) const;
    [[nodiscard]] Distance distance(const Point& from, const Point& to) const;
    [[nodiscard]] double seconds_between(const Point& from, const Point& to) const;
    [[nodiscard]] bool is_on_used_track(const Point& point) const;
    [[nodiscard]] bool hears_two(HostTime now) const;
    [[nodiscard]] bool is_recent(HostTime earlier, HostTime now) const;
    void note_jump(const Point& point);
    void adopt(const Point& point);

    std::vector<JointLimits> limits_;
    JointJumpConfig config_;
    std::uint64_t clock_ = 0;
    std::optional<Point> used_;             ///< the newest sample of the used track
    std::optional<Point> other_;            ///< the newest sample that jumped
    std::optional<HostTime> jumped_;        ///< the newest jump
    std::optional<HostTime> jumped_twice_;  ///< the newest jump less than a second after another
    std::optional<HostTime> strayed_;       ///< the newest jump that was on neither track
    std::optional<JointJumped> newest_;
};

}  // namespace octoskin
