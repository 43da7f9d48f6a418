// Which images go to the clients of `watch`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/time.hpp"

namespace octoskin::watch {

/// Lets one image of each camera in kPeriod through.
class ImagePace {
  public:
    static constexpr Nanoseconds kPeriod{200'000'000};

    /// True if this image goes out. A capture before the newest one does: a clock has stepped back. Throws
    /// std::bad_alloc. O(1).
    [[nodiscard]] bool takes(std::uint8_t camera, HostTime captured) {
        if (newest_.size() <= camera) newest_.resize(camera + std::size_t{1});
        std::optional<HostTime>& newest = newest_[camera];
        const Nanoseconds since = newest ? captured - *newest : kPeriod;
        if (since >= Nanoseconds{0} && since < kPeriod) return false;
        newest = captured;
        return true;
    }

  private:
    std::vector<std::optional<HostTime>> newest_;  ///< by camera
};

}  // namespace octoskin::watch
