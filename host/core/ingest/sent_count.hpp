// Readings of one sensor that its node sent, by the node's own count, against those that came.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin {

class SentCount {
  public:
    /// A reading came, whatever becomes of it.
    void on_arrival() noexcept;
    /// The node says that it has sent so many, modulo 2^16. A message that comes late, or once more, steps
    /// back by up to kBackMax, and counts for nothing. `received`: readings that came until now, each counted
    /// once. `now`: empty while unknown.
    void on_health(std::uint16_t sent, std::uint64_t received, std::optional<HostTime> now);
    /// The node began anew, and counts from 0: what is sent until its next message is not known.
    void restart() noexcept;

    /// Sent and never received: exact as of the newest message.
    [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
    /// For `patience` the node has said that it sent more than kOnTheWay since the newest that came.
    [[nodiscard]] bool are_missing(HostTime now, Nanoseconds patience) const noexcept;

    static constexpr std::uint16_t kBackMax = 4096;  ///< over a minute of the quickest sensor
    static constexpr std::uint64_t kOnTheWay = 2;    ///< may wait on the node, or be overtaken

  private:
    std::optional<std::uint16_t> newest_;  ///< of the messages the one that counted furthest
    std::uint64_t sent_ = 0;               ///< since the first message
    std::uint64_t received_first_ = 0;     ///< at that
    std::uint64_t received_newest_ = 0;    ///< at the newest
    std::uint64_t lost_ = 0;
    std::uint64_t lost_before_ = 0;  ///< of these, in the node's earlier lives
    std::uint64_t missing_ = 0;      ///< of these, since the newest reading that came
    std::optional<HostTime> missing_since_;
};

}  // namespace octoskin
