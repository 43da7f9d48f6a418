// The history of the joints of one source: takes samples and returns positions at any instant between them,
// never beyond them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/kinematics/joint_twist.hpp"
#include "host/core/kinematics/robot_model.hpp"

namespace octoskin {

inline constexpr std::size_t kSourceJointsMax = 7;  ///< the limit of a joint-state sample on the wire

/// Positions of a source's joints, radians (metres for a prismatic joint).
struct JointPosition {
    std::array<double, kSourceJointsMax> values{};
    std::size_t count = 0;
    [[nodiscard]] std::span<const double> span() const noexcept { return std::span(values).first(count); }
};

/// Why a sample was rejected; the history is unchanged.
enum class JointRejection : std::uint8_t {
    wrong_count,
    not_finite,
    outside_limits,
    out_of_order,  ///< not newer than the newest sample
};
inline constexpr std::size_t kJointRejections = 4;

/// Why there is no position for an instant.
enum class JointLookup : std::uint8_t {
    not_yet,       ///< newer than all samples: repeat the query after the next sample
    gap,           ///< the samples around it are too far apart; this is final
    before_first,  ///< older than the oldest sample in the history
};

struct JointHistoryConfig {
    Nanoseconds nearest_max = std::chrono::milliseconds(50);   ///< from the instant to the nearest sample
    Nanoseconds bracket_max = std::chrono::milliseconds(100);  ///< between the samples around it
    /// Tolerance of the joint limits: encoders and the wire's microradians round.
    double limit_tolerance = 0.005;
    std::size_t capacity = 1024;  ///< samples; the oldest is overwritten. 10 s at 100 Hz
};

/// Two samples that are too far apart for interpolation.
struct JointGap {
    Nanoseconds between{0};
    HostTime instant;  ///< the requested instant
    HostTime from;     ///< the earlier of the two
};

class JointHistory {
  public:
    /// `limits`: one per joint, at most kSourceJointsMax; `config.capacity` at least 2.
    explicit JointHistory(std::span<const JointLimits> limits, const JointHistoryConfig& config = {});

    /// Adds a sample or returns the reason for the rejection. O(joints), no allocation.
    Status<JointRejection> add(HostTime sampled, std::span<const double> position);

    /// Clears the history, because the samples' clock was reset.
    void forget() noexcept { size_ = 0; }

    /// The position at an instant: a sample's own, or interpolated linearly between the two samples around
    /// it, for a continuous joint the shorter way round. A value equal to a limit of the configuration is
    /// within it. O(log capacity), no allocation.
    [[nodiscard]] Result<JointPosition, JointLookup> at(HostTime instant) const;

    /// The samples around an instant for which `at` returns `gap` (asserted: there are two).
    [[nodiscard]] JointGap gap_about(HostTime instant) const;

    /// True if the result of `at` for this instant is final: there is a sample of that time or later. O(1).
    [[nodiscard]] bool is_settled(HostTime instant) const noexcept {
        return size_ > 0 && instant <= sample(size_ - 1).sampled;
    }

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    /// Time of the newest sample; empty if there is none.
    [[nodiscard]] std::optional<HostTime> newest() const noexcept {
        return size_ > 0 ? std::optional(sample(size_ - 1).sampled) : std::nullopt;
    }
    /// Visits all samples, the oldest first.
    void for_each(const std::function<void(HostTime, std::span<const double>)>& visit) const {
        for (std::size_t i = 0; i < size_; ++i) {
            visit(sample(i).sampled, std::span(sample(i).values).first(limits_.size()));
        }
    }

  private:
    struct Sample {
        HostTime sampled;
        std::array<double, kSourceJointsMax> values{};
    };
    [[nodiscard]] const Sample& sample(std::size_t age_rank) const noexcept;
    [[nodiscard]] std::size_t first_not_before(HostTime instant) const noexcept;
    [[nodiscard]] JointPosition interpolate(const Sample& before, const Sample& after,
                                            HostTime instant) const;

    std::vector<JointLimits> limits_;
    JointHistoryConfig config_;
    std::vector<Sample> ring_;
    std::size_t oldest_ = 0;
    std::size_t size_ = 0;
};

}  // namespace octoskin
