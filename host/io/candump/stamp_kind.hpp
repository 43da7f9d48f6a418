// What the times of a log count from: candump writes them in four ways, of which two look alike.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin::candump {

enum class StampKind : std::uint8_t {
    absolute,    ///< since 1970 (`-t a`, `-t A`, `-L`), or since the first frame (`-t z`)
    difference,  ///< since the frame before (`-t d`)
};

/// Tells them apart by the times of a log's first frames. Differences begin with 0, as times since the first
/// frame do, but do not add up: on a bus with more than one message they go back in one frame of twenty at
/// least.
class StampKindFinder {
  public:
    static constexpr std::uint64_t kFramesEnough = 4096;

    void take(WallTime stamp) noexcept {
        if (frames_ == 0) begins_with_zero_ = stamp.ns == 0;
        if (frames_ > 0 && stamp < newest_) ++back_;
        newest_ = stamp;
        ++frames_;
    }
    [[nodiscard]] bool has_enough() const noexcept { return !begins_with_zero_ || frames_ >= kFramesEnough; }
    [[nodiscard]] StampKind kind() const noexcept {
        const bool goes_back = back_ > 0 && 20 * back_ >= frames_;
        return frames_ > 0 && begins_with_zero_ && goes_back ? StampKind::difference : StampKind::absolute;
    }

  private:
    bool begins_with_zero_ = true;  ///< until the first frame
    std::uint64_t frames_ = 0;
    std::uint64_t back_ = 0;  ///< frames whose time is before that of the one above
    WallTime newest_;
};

}  // namespace octoskin::candump
