// What one sensor's readings said under each of the last 64 numbers: whether one that has a number of those
// is the same again, or another sender's.
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
        is_new,  ///< nothing came under its number within this turn of the numbers
        same,    ///< it was here already
        other,   ///< one with its number said something else
    };
    /// By arrival, which a node's clock cannot make wrong. `turn_min`: the numbers never come round quicker.
    /// Of one that says something else the contents are kept, too: a bus that repeats it tells nothing new.
    [[nodiscard]] Fate compare(const wire::RangeReading& reading, HostTime now, Nanoseconds turn_min);
    /// This reading has its number from now on.
    void take(const wire::RangeReading& reading, HostTime now);
    /// The numbers begin anew.
    void restart() noexcept { said_ = {}; }

  private:
    struct Said {
        wire::RangeReading reading;
        HostTime came;
        std::optional<wire::RangeReading> other;  ///< the newest that said something else
    };
    std::array<std::optional<Said>, wire::kSequenceCount> said_;
};

}  // namespace octoskin
