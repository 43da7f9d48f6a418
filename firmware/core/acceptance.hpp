// Decides on each result of one sensor: is it new, when was it taken, in which zone? Only a result that
// passes becomes a reading. The driver reads each result twice; the host interprets its status.
#pragma once

#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/reading.hpp"
#include "firmware/core/ready_tracker.hpp"
#include "firmware/core/time_bracket.hpp"
#include "firmware/core/zone_cycle.hpp"
#include "firmware/drivers/vl53l1x/measurement.hpp"

namespace octoskin::node {

/// A result as it was read, with its times.
struct ResultSeen {
    vl53l1x::Measurement measurement;
    NodeTime ready_seen;  ///< the data was ready no later than this
    NodeTime read_end;    ///< end of the read, after the interrupt was cleared
};

enum class Admission : std::uint8_t {
    accepted,
    refused,  ///< not new by its stream count or, after a start, by the polls
    undated,  ///< a good result whose time or zone is not known well enough
};

class Acceptance {
  public:
    Acceptance(StreamGate gate, Microseconds timing_budget, const Policy& policy) noexcept;

    /// Ranging was started at `started`, with a period within `uncertainty_permille` of `period`.
    void restart(NodeTime started, Microseconds period, std::int32_t uncertainty_permille) noexcept;

    /// A poll found no data. `asked`: the earliest time at which the sensor can have answered it.
    void on_not_ready(NodeTime asked) noexcept;
    /// A result was there, but its two reads did not agree, or it was implausible.
    void on_unreadable() noexcept;
    [[nodiscard]] Admission judge(const ResultSeen& seen, const ZoneCycle& zones) noexcept;

    /// The last accepted reading.
    [[nodiscard]] const Reading& reading() const noexcept { return reading_; }
    /// Whether a result was judged new since the start. The stream count then shows whether the next one is.
    [[nodiscard]] bool has_accepted() const noexcept { return last_stream_.has_value(); }
    /// Whether the last accepted result followed another one, which proves that the sensor measures.
    [[nodiscard]] bool is_proven() const noexcept { return is_proven_; }

    /// When the next result should become ready; empty before the first one.
    [[nodiscard]] std::optional<TimeBracket> next_ready() const noexcept;
    /// Whether a recent poll found the data not ready shortly before it was due, which proves that the sensor
    /// is not ahead of its rhythm. Always false where the stream count does not give the number of ranges.
    [[nodiscard]] bool is_rhythm_proven() const noexcept {
        return gate_ == StreamGate::advanced && unproven_readings_ < policy_.unproven_readings_max;
    }
    /// Whether the last poll, which found no data, should be repeated at once. A single poll is not trusted,
    /// and the one before it is too old to confirm it.
    [[nodiscard]] bool wants_poll_confirmed() const noexcept;
    /// Whether the next poll must be punctual: a late one would leave the next ready time too uncertain.
    [[nodiscard]] bool must_poll_punctually() const noexcept;
    /// Whether a poll that finds data must be confirmed by a second one: for the first result of a run, while
    /// the ready time is not well predicted, and for data that is overdue.
    [[nodiscard]] bool wants_ready_confirmed() const noexcept;
    /// The earliest time at which the range after the last result begins.
    [[nodiscard]] std::optional<NodeTime> next_range_begin() const noexcept;
    /// Whether results were refused or unreadable since the last accepted one.
    [[nodiscard]] bool has_refused() const noexcept { return results_refused_ > 0; }
    /// Whether the next result is certainly new: two polls found no data, so it cannot be left over from
    /// before the start.
    [[nodiscard]] bool is_next_new() const noexcept { return not_ready_polls_ >= 2; }
    /// Whether nothing was accepted for longer than the policy allows.
    [[nodiscard]] bool is_silent(NodeTime now) const noexcept;

    [[nodiscard]] Microseconds period() const noexcept { return tracker_.period(); }
    [[nodiscard]] std::optional<MeasuredPeriod> measured_period() const noexcept {
        return tracker_.measured_period();
    }

  private:
    [[nodiscard]] TimeBracket ready_time(const ResultSeen& seen, std::uint32_t ranges) noexcept;
    void on_stale() noexcept;
    [[nodiscard]] bool is_read_of(const TimeBracket& polled, const std::optional<TimeBracket>& predicted,
                                  NodeTime read_end, bool is_counted_next) const noexcept;
    [[nodiscard]] bool is_lone_poll_accepted(const std::optional<TimeBracket>& predicted) const noexcept;
    [[nodiscard]] bool is_count_in_doubt(std::optional<std::uint8_t> steps, NodeTime read_end) const noexcept;
    [[nodiscard]] Microseconds known_width(const TimeBracket& predicted) const noexcept;
    [[nodiscard]] bool has_seen_not_ready() const noexcept { return not_ready_polls_ > 0; }
    [[nodiscard]] bool has_count_come_round(std::optional<std::uint8_t> steps,
                                            NodeTime read_end) const noexcept;
    void forget_polls(NodeTime ready_since) noexcept;
    [[nodiscard]] bool is_new(const vl53l1x::Measurement& measurement) const noexcept;
    [[nodiscard]] std::optional<std::uint8_t> steps_to(std::uint8_t stream_count) const noexcept;

    StreamGate gate_;
    Microseconds budget_;
    const Policy& policy_;
    ReadyTracker tracker_;

    std::optional<std::uint8_t> last_stream_;
    std::optional<NodeTime> last_ready_;
    NodeTime last_accepted_;              ///< or the start
    NodeTime not_ready_at_;               ///< the last poll without data, or the previous result
    NodeTime not_ready_before_;           ///< the poll before that one, or the previous result
    std::uint32_t not_ready_polls_ = 0;   ///< since the last result
    bool was_stale_ = false;              ///< a result since the last accepted one was stale
    std::uint8_t unproven_readings_ = 0;  ///< in a row, with data ready at the first poll
    std::uint32_t results_refused_ = 0;   ///< since the last accepted one
    Reading reading_;
    bool is_proven_ = false;
};

}  // namespace octoskin::node
