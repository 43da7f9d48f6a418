// Whether a node's clock is to be asked: times that cannot be have come under its name since the newest
// exchange that agreed with those before.
#pragma once

#include <cstdint>
#include <optional>

namespace octoskin {

/// One such time may be a damaged frame's or a second sender's. It takes two sensors, or two in a row of one,
/// to ask for an exchange, and only that decides.
class ClockQuestion {
  public:
    /// A reading of this sensor had a time that cannot be.
    void on_impossible(std::uint8_t sensor) noexcept {
        is_asked_ = is_asked_ || (is_open_ && (sensor != sensor_ || is_last_));
        is_open_ = true;
        sensor_ = sensor;
        is_last_ = true;
    }
    /// One of this sensor had a time that fits.
    void on_possible(std::uint8_t sensor) noexcept { is_last_ = is_last_ && sensor != sensor_; }
    /// An exchange agreed with those before.
    void answer() noexcept { *this = {}; }

    [[nodiscard]] bool is_open() const noexcept { return is_open_; }
    [[nodiscard]] bool wants_exchange() const noexcept { return is_asked_; }

  private:
    bool is_open_ = false;
    bool is_asked_ = false;
    std::uint8_t sensor_ = 0;  ///< of the newest such reading
    bool is_last_ = false;     ///< none of that sensor fitted since
};

}  // namespace octoskin
