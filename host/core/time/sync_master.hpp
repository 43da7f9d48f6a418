// The host's half of the two-step synchronisation: when SYNC goes out, and the FOLLOW_UP that tells when it
// was on the bus. The nodes' answers come back through SyncExchange, as everybody's do.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

class SyncMaster {
  public:
    explicit SyncMaster(Nanoseconds period = Nanoseconds{1'000'000'000}) : period_(period) {}

    /// The SYNC to send now, if one is due. One that could not be sent is not made up for.
    [[nodiscard]] std::optional<wire::Sync> poll(HostTime now);
    /// The time is in doubt until the next exchange: the next SYNC is due a quarter of a period after the
    /// newest. Once only, then one comes as always: nobody has to bear more than twice the rate, whatever the
    /// doubt is about.
    void hasten() noexcept;
    /// Our SYNC of this number was on the bus, its end at `ended`: the FOLLOW_UP to send. Empty for any but
    /// the newest, and for the second time: which of two was meant cannot be told.
    [[nodiscard]] std::optional<wire::FollowUp> on_sent(std::uint8_t sequence, HostTime ended);

    /// The SYNC of an exchange that the host has with itself alone, once for each `poll`: that one's did not
    /// come onto the bus within half a period, for nobody is there to acknowledge it, or no bus. It has a
    /// number of its own, so that no answer to the other is taken for one to it.
    [[nodiscard]] std::optional<wire::Sync> poll_alone(HostTime now);

    /// When `poll` is next worth a call.
    [[nodiscard]] HostTime due() const noexcept { return due_; }

  private:
    void go_on();
    [[nodiscard]] HostTime early() const noexcept { return newest_ + period_ / 4; }
    Nanoseconds period_;
    HostTime due_{};
    HostTime newest_{};         ///< when `poll` last asked for one
    bool is_hastened_ = false;  ///< the newest one, or the one that is due
    std::uint8_t sequence_ = wire::kSyncSequenceCount - 1;
    bool is_awaited_ = false;
};

}  // namespace octoskin
