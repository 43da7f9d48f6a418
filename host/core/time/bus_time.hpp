// What time it is on the bus for somebody who asks between two frames, or after the last one.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace octoskin {

/// Whether a node is lost shows in how long the others were heard without it. A host that reads late, on a
/// machine that was busy or from an adapter that hung, must not count that against the nodes: the bus's time
/// is that of the newest frame of a node, and goes on by this machine's clock from when that was read.
class BusTime {
  public:
    /// Nobody speaks any more: from then on every node is lost, whether the bus's time was known or not.
    static constexpr Nanoseconds kSilent{350'000'000};

    /// A frame of a node of the rig was read at `read` on this machine's clock. `bus`: the bus's time at that
    /// frame; empty while unknown.
    void on_frame(HostTime read, std::optional<HostTime> bus) noexcept {
        read_ = read;
        is_known_ = bus.has_value();
        if (bus) ahead_ = *bus - read;
    }

    /// One of the host that tells the time, likewise. It tells nothing of who speaks; but where a clock was
    /// set the map is on the new one from that frame on, and where no node speaks nobody else tells it.
    void on_host_frame(HostTime read, std::optional<HostTime> bus) noexcept {
        if (bus) ahead_ = *bus - read;
    }

    /// On the clock that SYNC tells, which is taken for this machine's until it is known. Empty while nodes
    /// speak and their time is unknown or in doubt: how old anything is nobody can tell then.
    [[nodiscard]] std::optional<HostTime> at(HostTime now) const noexcept {
        const bool is_in_doubt = read_ && !is_known_ && !has_fallen_silent(now);
        return is_in_doubt ? std::nullopt : std::optional(reckoned_at(now));
    }

    /// The same, but in doubt, too: the newest that was known, gone on by this machine's clock. Enough for
    /// how long ago something was; not for where the bus's clock stands.
    [[nodiscard]] HostTime reckoned_at(HostTime now) const noexcept { return now + ahead_; }

    /// Nodes spoke, and do no more.
    [[nodiscard]] bool has_fallen_silent(HostTime now) const noexcept {
        return read_ && now - *read_ > kSilent;
    }

  private:
    std::optional<HostTime> read_;
    bool is_known_ = false;
    Nanoseconds ahead_{0};  ///< the bus's time less this machine's, at the newest frame whose time was known
};

}  // namespace octoskin
