// Judges each result of one sensor: is it new, when was it taken, in which zone? Only what passes becomes a
// reading. The double read is the driver's part; what the status means is the host's.
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

/// A result as it was read, and when.
struct ResultSeen {
    vl53l1x::Measurement measurement;
    NodeTime ready_seen;  ///< when the sensor answered that data is ready, at the latest
    NodeTime read_end;    ///< end of the read, interrupt cleared
};

enum class Verdict : std::uint8_t {
    accepted,
    refused,  ///< the stream count says that it is not new
    undated,  ///< a good result, but the time or zone it belongs to is not known well enough
};

class Acceptance {
  public:
    Acceptance(StreamGate gate, Microseconds timing_budget, const Policy& policy) noexcept;

    /// Ranging was started at `started`, with a period within `uncertainty_permille` of `period`.
    void restart(NodeTime started, Microseconds period, std::int32_t uncertainty_permille) noexcept;

    /// A poll that asked no sooner than at `asked` found no data.
    void on_not_ready(NodeTime asked) noexcept;
    /// A result was there, but could not be read twice alike, or made no sense.
    void on_unreadable() noexcept;
    [[nodiscard]] Verdict judge(const ResultSeen& seen, const ZoneCycle& zones) noexcept;

    /// The last accepted reading.
    [[nodiscard]] const Reading& reading() const noexcept { return reading_; }
    /// Whether a result was accepted since the start: the next one's stream count tells whether it is new.
    [[nodiscard]] bool has_accepted() const noexcept { return last_stream_.has_value(); }
    /// Whether the last accepted result was seen to follow another: the sensor measures.
    [[nodiscard]] bool is_proven() const noexcept { return is_proven_; }

    /// When the next result should become ready; empty until the first one was seen.
    [[nodiscard]] std::optional<TimeBracket> next_ready() const noexcept;
    /// Whether data was lately seen not to be ready before its time: the sensor is not ahead of its rhythm.
    /// Never where the stream count does not tell how many ranges it made.
    [[nodiscard]] bool is_rhythm_proven() const noexcept {
        return gate_ == StreamGate::advanced && unproven_readings_ < policy_.unproven_readings_max;
    }
    /// Whether the last poll, which found nothing, is worth asking again at once: alone it would not be
    /// believed, and the poll before it was long ago.
    [[nodiscard]] bool wants_poll_confirmed() const noexcept;
    /// Whether a poll that comes late would leave the next ready time known less well than it should be.
    [[nodiscard]] bool must_poll_punctually() const noexcept;
    /// Whether a poll that finds data needs a second one: for the first result of a run, and where polls
    /// found none when it was due.
    [[nodiscard]] bool wants_ready_confirmed() const noexcept;
    /// When the range after the last result begins: the earliest it can be.
    [[nodiscard]] std::optional<NodeTime> next_range_begin() const noexcept;
    /// Whether results came since the last accepted one, and none of them could be used.
    [[nodiscard]] bool has_refused() const noexcept { return results_refused_ > 0; }
    /// Whether data that becomes ready now could not be left over from before the start: two polls told.
    [[nodiscard]] bool is_next_new() const noexcept { return not_ready_polls_ >= 2; }
    /// Nothing was accepted for longer than the policy allows.
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
    [[nodiscard]] bool is_lone_poll_believed(const std::optional<TimeBracket>& predicted) const noexcept;
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
    NodeTime not_ready_at_;               ///< the last poll without data, or the result before
    NodeTime not_ready_before_;           ///< the poll before that one, or the result before
    std::uint32_t not_ready_polls_ = 0;   ///< since the last result
    bool was_stale_ = false;              ///< a result since the last accepted one
    std::uint8_t unproven_readings_ = 0;  ///< in a row, whose data was ready at the first poll
    std::uint32_t results_refused_ = 0;   ///< since the last accepted one
    Reading reading_;
    bool is_proven_ = false;
};

}  // namespace octoskin::node
