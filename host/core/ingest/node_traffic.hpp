// Checks that the traffic under a node id fits one node of the rig: at most twice the expected rate, and
// readings of one sender only.
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

/// Decides by host time, so that a replay decides as the daemon did.
///
/// Frames that a stalled machine delayed arrive in a bunch, which is not the node's fault. After a pause of
/// over 140 ms, the host time is unknown until an exchange confirms it (HostClockConfig::ahead_tolerance).
/// The caller then passes no time, nor in the second that follows, and frames are not counted. A shorter
/// pause moves the frames of at most a seventh of a second into another second, and a node sends half of what
/// it may.
class NodeTraffic {
  public:
    /// `joint_rate_hz`: rate of the joint states that it sends; 0 for none.
    NodeTraffic(const HostNode& node, double joint_rate_hz);

    /// A frame of this node that passed the format checks. False: more than `frames_max` arrived within a
    /// second. `now`: empty while frames are not to be counted.
    [[nodiscard]] bool keeps_with_frame(std::optional<HostTime> now);
    /// A reading of a sensor that the node has. False: the readings of more than half of its sensors are
    /// doubled. A sensor's readings are doubled if, within a second, more readings than half the rig's rate
    /// plus one have the number of the reading before or a lower one. With two senders, at least every second
    /// reading is such. A bus that repeats and delays causes fewer, and so does a node that restarts. If
    /// fewer sensors are doubled, the node is not at fault: SenderWatch.
    [[nodiscard]] bool keeps_with_reading(const wire::RangeReading& reading, std::optional<HostTime> now);

    /// Twice the node's frames per second by the rig, plus `kHeldBack`.
    [[nodiscard]] std::size_t frames_max() const noexcept { return frames_max_; }

    /// Frames beyond the limit that a second may contain: frames that waited in a controller or a socket's
    /// queue at its beginning were sent in the second before.
    static constexpr std::size_t kHeldBack = 8;

  private:
    std::size_t frames_max_;
    RateLimit frames_;
    struct Numbers {
        explicit Numbers(const HostSensor& sensor);
        RateLimit repeated;
        std::optional<std::uint8_t> newest;
        std::optional<HostTime> doubled;  ///< the newest repeated number beyond the limit
    };
    [[nodiscard]] bool are_most_doubled(HostTime now) const;
    std::vector<Numbers> numbers_;  ///< one for each sensor
};

}  // namespace octoskin
