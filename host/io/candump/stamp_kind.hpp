// The reference of a log's times: candump writes them in four ways, two of which look alike.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin::candump {

enum class StampKind : std::uint8_t {
    absolute,    ///< since 1970 (`-t a`, `-t A`, `-L`), or since the first frame (`-t z`)
    difference,  ///< since the previous frame (`-t d`)
};

/// Distinguishes them by the times of a log's first frames. Differences begin with 0, like times since the
/// first frame, but do not grow: on a bus with more than one message at least one frame of twenty has a
/// smaller time than the one before.
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
    std::uint64_t back_ = 0;  ///< frames with an earlier time than the previous line
    WallTime newest_;
};

}  // namespace octoskin::candump
