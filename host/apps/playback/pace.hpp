// How fast a recording is played: as fast as it goes, at so many times its own speed, or one thing at a time.
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
    /// Called before each thing with what it is; returns when it may happen.
    using Step = std::function<void(const std::string& what)>;

    /// As fast as it goes.
    Pace() = default;
    /// 1: real time; 10: ten times as fast. Positive and finite (asserted).
    [[nodiscard]] static Pace times(double speed);
    [[nodiscard]] static Pace by_step(Step step);

    /// Whether `wait` ever waits: what it is need not be told else.
    [[nodiscard]] bool waits() const noexcept { return speed_.has_value() || step_; }
    [[nodiscard]] bool steps() const noexcept { return static_cast<bool>(step_); }
    /// Until something of this time may happen: as long after the first one as it was then, divided by the
    /// speed. A time that goes back, or leaps by more than a minute, begins anew.
    void wait(std::int64_t time_ns, const std::string& what = {});

  private:
    std::optional<double> speed_;
    Step step_;
    std::int64_t first_ns_ = 0;         ///< of the recording
    std::int64_t newest_ns_ = 0;        ///< of the recording
    std::int64_t began_steady_ns_ = 0;  ///< when the first one happened
    bool has_begun_ = false;
};

/// Frames of a log, each at its time.
class PacedCan final : public CanSource {
  public:
    PacedCan(candump::LogSource& source, Pace pace) : source_(source), pace_(std::move(pace)) {}
    [[nodiscard]] Result<std::optional<StampedFrame>, CanSourceError> next() override;

  private:
    candump::LogSource& source_;
    Pace pace_;
};

/// Depth frames where nothing else tells the time, each at its own.
class PacedDepth final : public DepthSource {
  public:
    PacedDepth(DepthSource& source, Pace pace) : source_(source), pace_(std::move(pace)) {}
    [[nodiscard]] Result<std::optional<DepthFrame>, DepthSourceError> next() override;

  private:
    DepthSource& source_;
    Pace pace_;
    std::uint64_t frames_ = 0;
};

/// Commits of a daemon, each at its time. Joint samples of before `begin` (that of the recording; empty: its
/// first reading or depth frame) come at once: a recording starts with those that the daemon still had.
class PacedCommits final : public CommitSource {
  public:
    PacedCommits(CommitSource& source, Pace pace, std::optional<HostTime> begin)
        : source_(source), pace_(std::move(pace)), begin_(begin) {}
    [[nodiscard]] Result<std::optional<Commit>, CommitSourceError> next() override;

  private:
    CommitSource& source_;
    Pace pace_;
    std::optional<HostTime> begin_;
    bool has_begun_ = false;
};

}  // namespace octoskin
