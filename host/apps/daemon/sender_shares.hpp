// What each program may send to a socket: one that floods it leaves room for the others.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace octoskin {

/// A program, as far as it can be told from others.
struct SenderKey {
    pid_t pid = 0;        ///< 0: cannot be seen
    std::string address;  ///< of one that cannot be seen: what its socket is bound to; empty: to nothing
    friend bool operator==(const SenderKey&, const SenderKey&) = default;
};

class SenderShares {
  public:
    /// Twice what the quickest driver has to say: the rig's joints.rate_hz is 1000 at the most.
    static constexpr double kPerSecond = 2048.0;
    /// At once: what a program may have sent while nobody received for a second.
    static constexpr double kAtOnce = 2048.0;
    /// Of a flood of programs as many have a share: those that were found useful within the last second
    /// (`keep`) keep theirs, the others lose it to any program that has none.
    static constexpr std::size_t kSendersMax = 8;

    /// One datagram of this program came at `now`; false: it is beyond what may be taken. O(kSendersMax).
    [[nodiscard]] bool take(const SenderKey& sender, HostTime now);
    /// One that came at `came` was useful: the program keeps its share, or has one again. O(kSendersMax).
    void keep(const SenderKey& sender, HostTime came);

  private:
    struct Share {
        SenderKey sender;
        double left = kAtOnce;
        HostTime newest;
        std::optional<HostTime> useful;  ///< the newest of those that were
    };
    [[nodiscard]] Share* share_of(const SenderKey& sender, HostTime now);
    [[nodiscard]] Share* share_to_lose(HostTime now);

    std::vector<Share> shares_;
};

}  // namespace octoskin
