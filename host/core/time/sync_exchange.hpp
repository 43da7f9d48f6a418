// Two-step synchronisation seen from the side: SYNC, the host's FOLLOW_UP and the nodes' reports of one
// sequence number, in any order after the SYNC, become one pair of readings per node.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// One instant, the end of a SYNC frame, on both clocks.
struct SyncSample {
    HostTime host;
    NodeTime heard;
};

/// The same instant on the host's clock and in the log's stamps.
struct SyncStamp {
    HostTime host;
    WallTime stamp;
};

enum class SyncFault : std::uint8_t {
    unmatched,     ///< belongs to no SYNC that is open: its SYNC was lost, or it came too late
    repeated,      ///< a second one of its kind for this SYNC
    contradicted,  ///< an answer of this node to this SYNC is here and tells another time: two senders
};

class SyncExchange {
  public:
    /// Opens an exchange; the one before is over. A second SYNC of the same number makes both ambiguous: the
    /// exchange is closed without result.
    [[nodiscard]] Status<SyncFault> on_sync(const wire::Sync& sync, WallTime stamp);
    [[nodiscard]] Result<SyncStamp, SyncFault> on_follow_up(const wire::FollowUp& follow_up);
    [[nodiscard]] Status<SyncFault> on_report(wire::NodeId node, const wire::SyncReport& report);

    /// The pairs of readings of `node`, as soon as report and FOLLOW_UP are both here; again, with all before
    /// it, whenever one more answer differs from them. Empty while there is nothing new.
    [[nodiscard]] std::vector<SyncSample> take_samples(wire::NodeId node);

    /// Answers that differ by no more may be one sender's: a bus that repeats a SYNC has a node answer twice.
    static constexpr Microseconds kOneInstant{1'000};
    /// Of the answers under one id as many are kept.
    static constexpr std::size_t kAnswersMax = 4;

  private:
    struct Answers {
        std::array<NodeTime, kAnswersMax> heard{};
        std::size_t count = 0;
        bool has_new = false;  ///< since they were taken
    };

    std::optional<std::uint8_t> sequence_;  ///< of the open exchange
    std::uint8_t sequence_last_ = 0xFF;     ///< of the newest SYNC, open or not
    WallTime stamp_;
    std::optional<HostTime> host_;
    std::array<Answers, wire::kBroadcastId + 1> answers_{};
};

}  // namespace octoskin
