// Observes the two-step synchronisation. The SYNC, the host's FOLLOW_UP and the nodes' reports of one
// sequence number, in any order after the SYNC, give one pair of clock readings per node.
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

/// The end of a SYNC frame on both clocks.
struct SyncSample {
    HostTime host;
    NodeTime heard;
};

/// The end of a SYNC frame on the host's clock and as the log's time stamp.
struct SyncStamp {
    HostTime host;
    WallTime stamp;
};

enum class SyncFault : std::uint8_t {
    unmatched,     ///< belongs to no open SYNC: its SYNC was lost, or it came too late
    repeated,      ///< a second one of its kind for this SYNC
    contradicted,  ///< this node has already answered this SYNC with another time: two senders
};

class SyncExchange {
  public:
    /// Opens an exchange and ends the one before. A second SYNC of the same number makes both ambiguous: the
    /// exchange is closed without a result.
    [[nodiscard]] Status<SyncFault> on_sync(const wire::Sync& sync, WallTime stamp);
    [[nodiscard]] Result<SyncStamp, SyncFault> on_follow_up(const wire::FollowUp& follow_up);
    [[nodiscard]] Status<SyncFault> on_report(wire::NodeId node, const wire::SyncReport& report);

    /// The pairs of readings of `node`, as soon as both report and FOLLOW_UP have arrived. Returns all pairs
    /// again each time a different answer arrives. Empty while there is nothing new.
    [[nodiscard]] std::vector<SyncSample> take_samples(wire::NodeId node);

    /// Answers within this distance may come from one sender: if the bus repeats a SYNC, a node answers
    /// twice.
    static constexpr Microseconds kOneInstant{1'000};
    /// Number of answers that are stored per node id.
    static constexpr std::size_t kAnswersMax = 4;

  private:
    struct Answers {
        std::array<NodeTime, kAnswersMax> heard{};
        std::size_t count = 0;
        bool has_new = false;  ///< since the last take_samples()
    };

    std::optional<std::uint8_t> sequence_;  ///< of the open exchange
    std::uint8_t sequence_last_ = 0xFF;     ///< number of the newest SYNC, open or not
    WallTime stamp_;
    std::optional<HostTime> host_;
    std::array<Answers, wire::kBroadcastId + 1> answers_{};
};

}  // namespace octoskin
