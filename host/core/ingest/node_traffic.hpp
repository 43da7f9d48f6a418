// Whether what comes under a node id is what the rig has one node say: not over twice as much, and not two
// senders' readings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/core/ingest/rate_limit.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// Judged by "now" on the bus, so that a replay judges as the daemon did.
///
/// Frames that a stalled machine held back come in a bunch, and that is no fault of their node. After a pause
/// of over 140 ms "now" is unknown until an exchange confirms it (HostClockConfig::ahead_tolerance); whoever
/// calls gives no time then, nor in the second that follows: what comes is not counted. A shorter pause moves
/// a seventh of a second's frames at most into another second, and a node sends half of what it may.
class NodeTraffic {
  public:
    /// `joint_rate_hz`: of the joint states that it sends; 0 for none.
    NodeTraffic(const HostNode& node, double joint_rate_hz);

    /// A frame of this node that passed the checks of its format. False: over `frames_max` came within a
    /// second. `now`: empty while nothing is to be counted.
    [[nodiscard]] bool keeps_with_frame(std::optional<HostTime> now);
    /// A reading of a sensor that it has. False: the readings of more than half of its sensors are doubled.
    /// Those of one are where more of a second's were numbered as the one before, or lower, than half of what
    /// the rig has of it in a second, and one. Of two senders' readings at least every second one is; a bus
    /// that repeats and delays makes fewer, and so does a node that begins anew. Of fewer sensors the node is
    /// not to blame: SenderWatch.
    [[nodiscard]] bool keeps_with_reading(const wire::RangeReading& reading, std::optional<HostTime> now);

    /// Twice what the rig has the node send in a second, and `kHeldBack`.
    [[nodiscard]] std::size_t frames_max() const noexcept { return frames_max_; }

    /// Frames beyond the limit that a second may hold: what waited in a controller, or in a socket's queue,
    /// when it began was sent in the one before.
    static constexpr std::size_t kHeldBack = 8;

  private:
    std::size_t frames_max_;
    RateLimit frames_;
    struct Numbers {
        explicit Numbers(const HostSensor& sensor);
        RateLimit repeated;
        std::optional<std::uint8_t> newest;
        std::optional<HostTime> doubled;  ///< the newest that was one too many
    };
    [[nodiscard]] bool are_most_doubled(HostTime now) const;
    std::vector<Numbers> numbers_;  ///< of each sensor
};

}  // namespace octoskin
