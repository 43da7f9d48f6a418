// The time on the bus at any moment: between two frames, and after the last one.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace octoskin {

/// A node is lost if the other nodes were received for long enough without it. A host that reads late,
/// because the machine was busy or the adapter hung, must not count that delay against the nodes. The bus
/// time is therefore that of the newest frame of a node, advanced by this machine's clock from the moment at
/// which the frame was read.
class BusTime {
  public:
    /// After this silence of all nodes, each node is lost, whether the bus time was known or not.
    static constexpr Nanoseconds kSilent{350'000'000};

    /// A frame of a node of the rig was read at `read` on this machine's clock. `bus`: the bus time at that
    /// frame; empty while it is unknown.
    void on_frame(HostTime read, std::optional<HostTime> bus) noexcept {
        read_ = read;
        is_known_ = bus.has_value();
        if (bus) ahead_ = *bus - read;
    }

    /// A frame of the host that sends SYNC, with the same arguments. It does not show that a node is active.
    /// But after a clock was set, the map uses the new clock from that frame on, and without active nodes no
    /// other frame carries the time.
    void on_host_frame(HostTime read, std::optional<HostTime> bus) noexcept {
        if (bus) ahead_ = *bus - read;
    }

    /// The bus time on the clock of SYNC, which is taken for this machine's clock until it is known. Empty
    /// while nodes are active and their time is unknown or in doubt: ages cannot be computed then.
    [[nodiscard]] std::optional<HostTime> at(HostTime now) const noexcept {
        const bool is_in_doubt = read_ && !is_known_ && !has_fallen_silent(now);
        return is_in_doubt ? std::nullopt : std::optional(reckoned_at(now));
    }

    /// The same, also while in doubt: the newest known bus time, advanced by this machine's clock. Sufficient
    /// for ages, but not for absolute times on the bus clock.
    [[nodiscard]] HostTime reckoned_at(HostTime now) const noexcept { return now + ahead_; }

    /// True if nodes were active and no longer are.
    [[nodiscard]] bool has_fallen_silent(HostTime now) const noexcept {
        return read_ && now - *read_ > kSilent;
    }

  private:
    std::optional<HostTime> read_;
    bool is_known_ = false;
    Nanoseconds ahead_{0};  ///< bus time less this machine's time, at the newest frame with a known bus time
};

}  // namespace octoskin
