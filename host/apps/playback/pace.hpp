// The speed of a playback: as fast as possible, at a multiple of real time, or one item at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "host/core/depth/depth_source.hpp"
#include "host/core/pipeline/can_source.hpp"
#include "host/core/pipeline/ordered_replay.hpp"
#include "host/io/candump/log_source.hpp"

namespace octoskin {

class Pace {
  public:
    /// Called before each item with its description; returns when the item may be played.
    using Step = std::function<void(const std::string& what)>;

    /// As fast as possible.
    Pace() = default;
    /// 1: real time; 10: ten times as fast. Must be positive and finite (asserted).
    [[nodiscard]] static Pace times(double speed);
    [[nodiscard]] static Pace by_step(Step step);

    /// Whether `wait` ever waits; if not, it needs no description.
    [[nodiscard]] bool waits() const noexcept { return speed_.has_value() || step_; }
    [[nodiscard]] bool steps() const noexcept { return static_cast<bool>(step_); }
    /// Waits until an item of this time is due: its distance from the first item, divided by the speed. A
    /// time that goes back, or jumps by more than a minute, restarts the time base.
    void wait(std::int64_t time_ns, const std::string& what = {});

  private:
    std::optional<double> speed_;
    Step step_;
    std::int64_t first_ns_ = 0;         ///< of the recording
    std::int64_t newest_ns_ = 0;        ///< of the recording
    std::int64_t began_steady_ns_ = 0;  ///< wall time of the first item
    bool has_begun_ = false;
};

/// The frames of a log, each at its time.
class PacedCan final : public CanSource {
  public:
    PacedCan(candump::LogSource& source, Pace pace) : source_(source), pace_(std::move(pace)) {}
    [[nodiscard]] Result<std::optional<StampedFrame>, Error> next() override;

  private:
    candump::LogSource& source_;
    Pace pace_;
};

/// Depth frames without another time source, each at its own time.
class PacedDepth final : public DepthSource {
  public:
    PacedDepth(DepthSource& source, Pace pace) : source_(source), pace_(std::move(pace)) {}
    [[nodiscard]] Result<std::optional<DepthFrame>, Error> next() override;

  private:
    DepthSource& source_;
    Pace pace_;
    std::uint64_t frames_ = 0;
};

/// The commits of a daemon, each at its time. Joint samples before `begin` (of the recording; empty: its
/// first reading or depth frame) come without delay: a recording starts with the samples that the daemon
/// still held.
class PacedCommits final : public CommitSource {
  public:
    PacedCommits(CommitSource& source, Pace pace, std::optional<HostTime> begin)
        : source_(source), pace_(std::move(pace)), begin_(begin) {}
    [[nodiscard]] Result<std::optional<Commit>, Error> next() override;

  private:
    CommitSource& source_;
    Pace pace_;
    std::optional<HostTime> begin_;
    bool has_begun_ = false;
};

}  // namespace octoskin
