// Readings of one sensor that its node sent, by the node's own count, against those that came.
#pragma once

#include <array>
#include <cstddef>
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

    struct Loss {
        std::uint64_t lost = 0;
        std::uint64_t sent = 0;
        Nanoseconds within{0};
        [[nodiscard]] bool is_over(double share) const noexcept {
            return static_cast<double>(lost) > share * static_cast<double>(sent);
        }
    };
    /// Over the newest kSteps steps between messages; a step has a second or so, and at least kStepSent
    /// readings sent. Empty: there are no so many, or the newest message is older than 3 s.
    [[nodiscard]] std::optional<Loss> newest_loss(HostTime now, std::size_t steps = kSteps) const noexcept;
    /// What was lost so far is no sign of what is lost from now on.
    void forget_steps() noexcept { marks_count_ = 0; }
    static constexpr std::size_t kSteps = 3;
    static constexpr std::uint64_t kStepSent = 4;

    static constexpr std::uint16_t kBackMax = 4096;  ///< over a minute of the quickest sensor
    static constexpr std::uint64_t kOnTheWay = 2;    ///< may wait on the node, or be overtaken

  private:
    struct Mark {
        HostTime at;
        std::uint64_t sent = 0;
        std::uint64_t received = 0;
    };
    void set_mark(const Mark& mark) noexcept;

    std::optional<std::uint16_t> newest_;  ///< of the messages the one that counted furthest
    std::uint64_t sent_ = 0;               ///< since the first message
    std::uint64_t received_first_ = 0;     ///< at that
    std::uint64_t received_newest_ = 0;    ///< at the newest
    std::uint64_t lost_ = 0;
    std::uint64_t lost_before_ = 0;  ///< of these, in the node's earlier lives
    std::uint64_t missing_ = 0;      ///< of these, since the newest reading that came
    std::optional<HostTime> missing_since_;
    std::array<Mark, kSteps + 1> marks_{};  ///< the newest last
    std::size_t marks_count_ = 0;
    std::optional<HostTime> newest_at_;  ///< the newest message
};

}  // namespace octoskin
