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
    NodeTime ready_seen;  ///< end of the poll that saw data ready
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

    /// A poll begun at `asked` found no data.
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
    /// When the range after the last result begins: the earliest it can be.
    [[nodiscard]] std::optional<NodeTime> next_range_begin() const noexcept;
    /// Whether results came since the last accepted one, and none of them could be used.
    [[nodiscard]] bool has_refused() const noexcept { return results_refused_ > 0; }
    /// Nothing was accepted for longer than the policy allows.
    [[nodiscard]] bool is_silent(NodeTime now) const noexcept;

    [[nodiscard]] Microseconds period() const noexcept { return tracker_.period(); }
    [[nodiscard]] std::optional<MeasuredPeriod> measured_period() const noexcept {
        return tracker_.measured_period();
    }

  private:
    [[nodiscard]] std::uint32_t ranges_since_last(std::optional<std::uint8_t> steps,
                                                  NodeTime read_end) const noexcept;
    [[nodiscard]] TimeBracket ready_bracket(const ResultSeen& seen, std::uint32_t ranges) const noexcept;
    [[nodiscard]] bool is_new(const vl53l1x::Measurement& measurement) const noexcept;
    [[nodiscard]] std::optional<std::uint8_t> steps_to(std::uint8_t stream_count) const noexcept;

    StreamGate gate_;
    Microseconds budget_;
    const Policy& policy_;
    ReadyTracker tracker_;

    std::optional<std::uint8_t> last_stream_;
    std::optional<NodeTime> last_ready_;
    NodeTime last_accepted_;             ///< or the start
    NodeTime not_ready_at_;              ///< the next data was certainly not ready then
    bool has_seen_not_ready_ = false;    ///< since the last result
    std::uint32_t results_refused_ = 0;  ///< since the last accepted one
    Reading reading_;
    bool is_proven_ = false;
};

}  // namespace octoskin::node
