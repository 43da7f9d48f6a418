// Compares the readings of one sensor that its node sent, by the node's count, with those that arrived.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin {

class SentCount {
  public:
    /// A reading arrived, whatever its result.
    void on_arrival() noexcept;
    /// The node reports that it has sent `sent` readings, modulo 2^16. A late or repeated message steps back
    /// by up to kBackMax and is ignored. `received`: readings that arrived until now, each counted once.
    /// `now`: empty while unknown.
    void on_health(std::uint16_t sent, std::uint64_t received, std::optional<HostTime> now);
    /// The node restarted and counts from 0: what it sends until its next message is unknown.
    void restart() noexcept;

    /// Readings that were sent and never received: exact as of the newest message.
    [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
    /// True if for `patience` the node's count has exceeded the newest reading that arrived by more than
    /// kOnTheWay.
    [[nodiscard]] bool are_missing(HostTime now, Nanoseconds patience) const noexcept;

    struct Loss {
        std::uint64_t lost = 0;
        std::uint64_t sent = 0;
        Nanoseconds within{0};
        [[nodiscard]] bool is_over(double share) const noexcept {
            return static_cast<double>(lost) > share * static_cast<double>(sent);
        }
    };
    /// Loss over the newest `steps` steps between messages. A step has about a second, and at least kStepSent
    /// sent readings. Empty: there are fewer steps, or the newest message is older than 3 s.
    [[nodiscard]] std::optional<Loss> newest_loss(HostTime now, std::size_t steps = kSteps) const noexcept;
    /// Losses so far do not predict the losses from now on: clears the steps.
    void forget_steps() noexcept { marks_count_ = 0; }
    static constexpr std::size_t kSteps = 3;
    static constexpr std::uint64_t kStepSent = 4;

    static constexpr std::uint16_t kBackMax = 4096;  ///< over a minute of the fastest sensor
    static constexpr std::uint64_t kOnTheWay = 2;    ///< readings that may wait on the node, or be overtaken

  private:
    struct Mark {
        HostTime at;
        std::uint64_t sent = 0;
        std::uint64_t received = 0;
    };
    void set_mark(const Mark& mark) noexcept;

    std::optional<std::uint16_t> newest_;  ///< of the message with the highest count
    std::uint64_t sent_ = 0;               ///< since the first message
    std::uint64_t received_first_ = 0;     ///< at the first message
    std::uint64_t received_newest_ = 0;    ///< at the newest message
    std::uint64_t lost_ = 0;
    std::uint64_t lost_before_ = 0;  ///< of these, before the node's last restart
    std::uint64_t missing_ = 0;      ///< of these, since the newest reading that arrived
    std::optional<HostTime> missing_since_;
    std::array<Mark, kSteps + 1> marks_{};  ///< the newest last
    std::size_t marks_count_ = 0;
    std::optional<HostTime> newest_at_;  ///< time of the newest message
};

}  // namespace octoskin
