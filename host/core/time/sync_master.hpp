// The host's part of the two-step synchronisation: when SYNC is due, and the FOLLOW_UP with the time at which
// SYNC was on the bus. The nodes' answers arrive through SyncExchange, as for all hosts.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

class SyncMaster {
  public:
    explicit SyncMaster(Nanoseconds period = Nanoseconds{1'000'000'000}) : period_(period) {}

    /// The SYNC to send now, if one is due. A SYNC that could not be sent is not repeated.
    [[nodiscard]] std::optional<wire::Sync> poll(HostTime now);
    /// The time is in doubt until the next exchange: the next SYNC is due a quarter of a period after the
    /// newest one. Works once, then one SYNC follows at the usual time: the rate never exceeds twice the
    /// usual rate.
    void hasten() noexcept;
    /// The SYNC with this number was on the bus, its end at `ended`: returns the FOLLOW_UP to send. Empty for
    /// any SYNC but the newest, and for a second call: it is then ambiguous which SYNC is meant.
    [[nodiscard]] std::optional<wire::FollowUp> on_sent(std::uint8_t sequence, HostTime ended);

    /// The SYNC of an exchange of the host with itself, once for each `poll`. It is used if the SYNC of
    /// `poll` does not appear on the bus within half a period, because no node acknowledges it or there is no
    /// bus. It has its own number, so that no answer to the other SYNC is assigned to it.
    [[nodiscard]] std::optional<wire::Sync> poll_alone(HostTime now);

    /// When `poll` next returns a SYNC.
    [[nodiscard]] HostTime due() const noexcept { return due_; }

  private:
    void go_on();
    [[nodiscard]] HostTime early() const noexcept { return newest_ + period_ / 4; }
    Nanoseconds period_;
    HostTime due_{};
    HostTime newest_{};         ///< when `poll` last returned a SYNC
    bool is_hastened_ = false;  ///< the newest SYNC, or the one that is due, was brought forward
    std::uint8_t sequence_ = wire::kSyncSequenceCount - 1;
    bool is_awaited_ = false;
};

}  // namespace octoskin
