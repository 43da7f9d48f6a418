// Whether the arm can have moved from one joint sample to the next in the time between. Where two programs
// tell joint states under one name, and nothing else tells them apart, this does.
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
    /// Times the velocity limit of the joint: drivers round, and controllers overshoot.
    double velocity_margin = 1.5;
    /// Of the two times together. A sample without a time of its own is dated by when it came, and what is
    /// sent every 10 ms may come in bursts every 20 ms.
    Nanoseconds time_uncertainty{20'000'000};
    /// Radians or metres: a text of two decimals.
    double resolution = 0.01;
    /// Who has been silent for so long is heard no more.
    Nanoseconds heard_for{1'000'000'000};
};

/// A sample that is too far from the one before it.
struct JointJumped {
    std::size_t joint = 0;  ///< the one that is the furthest beyond what it may
    double from = 0.0;      ///< radians or metres
    double to = 0.0;
    double step_max = 0.0;  ///< what the joint may move in that time
    Nanoseconds passed{0};
    HostTime sampled;
};

/// Follows two tracks: the one whose samples are used, and the newest that is too far from it. One sample
/// that jumps is refused alone. After two within a second two senders are heard: neither is used until no
/// sample has jumped for a second, or the track that was used has been silent for one. So a first sample that
/// was wrong costs a second, and no track is shut out for ever.
class JointJump {
  public:
    /// `limits`: one per joint, at most kJointsMax, each with a velocity above 0 (asserted).
    explicit JointJump(std::span<const JointLimits> limits, const JointJumpConfig& config = {});

    enum class Verdict : std::uint8_t {
        fits,
        jumped,    ///< the sample is too far from the track that is used
        withheld,  ///< it is on that track, and another is heard
    };
    /// Samples in the order of their times: one that is not later than the newest is for the history to
    /// refuse. `position` has one finite value per joint (asserted). `clock`: times of two clocks say nothing
    /// of what passed between them: with another one it begins anew. O(1), no allocation.
    [[nodiscard]] Verdict judge(HostTime sampled, std::span<const double> position, std::uint64_t clock = 0);

    /// As if there had been no sample.
    void forget() noexcept;

    /// The newest sample that jumped; empty if none did.
    [[nodiscard]] const std::optional<JointJumped>& newest() const noexcept { return newest_; }

  private:
    struct Point {
        HostTime sampled;
        std::array<double, kJointsMax> position{};
    };
    /// The largest movement of a joint from there to here, as a multiple of what it may; and that joint.
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
    std::optional<Point> used_;             ///< the newest sample of the track that is used
    std::optional<Point> other_;            ///< the newest that jumped
    std::optional<HostTime> jumped_;        ///< the newest jump
    std::optional<HostTime> jumped_twice_;  ///< the newest jump less than a second after another
    std::optional<HostTime> strayed_;       ///< the newest jump that was on neither track
    std::optional<JointJumped> newest_;
};

}  // namespace octoskin
