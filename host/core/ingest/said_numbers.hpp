// Contents of one sensor's readings under each of the last 64 numbers: decides whether a reading that reuses
// one of these numbers is a repeat or comes from another sender.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

class SaidNumbers {
  public:
    enum class Fate : std::uint8_t {
        is_new,  ///< no reading arrived under its number within this round of the numbers
        same,    ///< the same reading was received before
        other,   ///< a reading with its number had other contents
    };
    /// Compares by arrival time, which a wrong node clock does not affect. `turn_min`: the shortest time in
    /// which the numbers wrap. Of a reading with other contents, the contents are stored, too: its repeats
    /// are not counted again.
    [[nodiscard]] Fate compare(const wire::RangeReading& reading, HostTime now, Nanoseconds turn_min);
    /// This reading has its number from now on.
    void take(const wire::RangeReading& reading, HostTime now);
    /// The numbers restart.
    void restart() noexcept { said_ = {}; }

  private:
    struct Said {
        wire::RangeReading reading;
        HostTime came;
        std::optional<wire::RangeReading> other;  ///< the newest with other contents
    };
    std::array<std::optional<Said>, wire::kSequenceCount> said_;
};

}  // namespace octoskin
