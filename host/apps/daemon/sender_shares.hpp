// The share of each program that sends to a socket: one that floods it leaves room for the others.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace octoskin {

/// Identifies a program, as far as it can be distinguished.
struct SenderKey {
    pid_t pid = 0;        ///< 0: not visible
    std::string address;  ///< for one that is not visible: the address its socket is bound to; empty: none
    friend bool operator==(const SenderKey&, const SenderKey&) = default;
};

class SenderShares {
  public:
    /// Twice the rate of the fastest driver: the rig's joints.rate_hz is at most 1000.
    static constexpr double kPerSecond = 2048.0;
    /// The burst: as many as a program may have sent while the receiver paused for a second.
    static constexpr double kAtOnce = 2048.0;
    /// In a flood of programs this many have a share. Those that sent something useful within the last second
    /// (`keep`) keep theirs; the others lose it to any program that has none.
    static constexpr std::size_t kSendersMax = 8;

    /// Counts one datagram of this program at `now`; false: it exceeds the share. O(kSendersMax).
    [[nodiscard]] bool take(const SenderKey& sender, HostTime now);
    /// One received at `came` was useful: the program keeps its share, or gets one again. O(kSendersMax).
    void keep(const SenderKey& sender, HostTime came);

  private:
    struct Share {
        SenderKey sender;
        double left = kAtOnce;
        HostTime newest;
        std::optional<HostTime> useful;  ///< the newest useful one
    };
    [[nodiscard]] Share* share_of(const SenderKey& sender, HostTime now);
    [[nodiscard]] Share* share_to_lose(HostTime now);

    std::vector<Share> shares_;
};

}  // namespace octoskin
