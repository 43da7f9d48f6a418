// Whether to request a SYNC exchange with a node: readings with impossible times have come under its id since
// the newest exchange that agreed with earlier ones.
#pragma once

#include <cstdint>
#include <optional>

namespace octoskin {

/// One impossible time may come from a damaged frame or a second sender. An exchange is requested only after
/// impossible times of two sensors, or two in a row of one sensor. Only the exchange decides.
class ClockQuestion {
  public:
    /// A reading of this sensor had an impossible time.
    void on_impossible(std::uint8_t sensor) noexcept {
        is_asked_ = is_asked_ || (is_open_ && (sensor != sensor_ || is_last_));
        is_open_ = true;
        sensor_ = sensor;
        is_last_ = true;
    }
    /// A reading of this sensor had a plausible time.
    void on_possible(std::uint8_t sensor) noexcept { is_last_ = is_last_ && sensor != sensor_; }
    /// An exchange agreed with earlier ones.
    void answer() noexcept { *this = {}; }

    [[nodiscard]] bool is_open() const noexcept { return is_open_; }
    [[nodiscard]] bool wants_exchange() const noexcept { return is_asked_; }

  private:
    bool is_open_ = false;
    bool is_asked_ = false;
    std::uint8_t sensor_ = 0;  ///< sensor of the newest impossible time
    bool is_last_ = false;     ///< no plausible time of that sensor since
};

}  // namespace octoskin
