// Where the joints were: samples in, positions at any instant between them out. Never beyond them.
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

/// The position of every moved joint, radians (metres for a prismatic joint).
struct JointPosition {
    std::array<double, kJointsMax> values{};
    std::size_t count = 0;
    [[nodiscard]] std::span<const double> span() const noexcept { return std::span(values).first(count); }
};

/// Why a sample was not taken; the history is unchanged.
enum class JointRejection : std::uint8_t {
    wrong_count,
    not_finite,
    outside_limits,
    out_of_order,  ///< not newer than the newest sample
};
inline constexpr std::size_t kJointRejections = 4;

/// Why there is no position for an instant.
enum class JointLookup : std::uint8_t {
    not_yet,       ///< newer than every sample: ask again after the next one
    gap,           ///< the samples about it are too far apart, now and for ever
    before_first,  ///< older than the oldest sample held
};

struct JointHistoryConfig {
    Nanoseconds nearest_max = std::chrono::milliseconds(50);   ///< from the instant to the nearest sample
    Nanoseconds bracket_max = std::chrono::milliseconds(100);  ///< between the samples about it
    /// A sample this far outside its limits is still taken: encoders and the wire's microradians round.
    double limit_tolerance = 0.005;
    std::size_t capacity = 1024;  ///< samples; the oldest gives way. 10 s at 100 Hz
};

/// Two samples that no position is given between.
struct JointGap {
    Nanoseconds between{0};
    HostTime instant;  ///< that was asked for
    HostTime from;     ///< the earlier of the two
};

class JointHistory {
  public:
    /// `limits`: one per joint, at most kJointsMax; `config.capacity` at least 2.
    explicit JointHistory(std::span<const JointLimits> limits, const JointHistoryConfig& config = {});

    /// Takes a sample or says why not. O(joints), no allocation.
    Status<JointRejection> add(HostTime sampled, std::span<const double> position);

    /// As if there had been no sample: their clock began anew.
    void forget() noexcept { size_ = 0; }

    /// The position at an instant: a sample's own, or interpolated linearly between the two about it.
    /// Equality with a limit of the configuration is within it. O(log capacity), no allocation.
    [[nodiscard]] Result<JointPosition, JointLookup> at(HostTime instant) const;

    /// The samples about an instant for which `at` answers `gap` (asserted: there are two).
    [[nodiscard]] JointGap gap_about(HostTime instant) const;

    /// Whether `at` gives its last word on this instant: a sample of that time or later is here. O(1).
    [[nodiscard]] bool is_settled(HostTime instant) const noexcept {
        return size_ > 0 && instant <= sample(size_ - 1).sampled;
    }

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    /// Every sample that is held, the oldest first.
    void for_each(const std::function<void(HostTime, std::span<const double>)>& visit) const {
        for (std::size_t i = 0; i < size_; ++i) {
            visit(sample(i).sampled, std::span(sample(i).values).first(limits_.size()));
        }
    }

  private:
    struct Sample {
        HostTime sampled;
        std::array<double, kJointsMax> values{};
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
