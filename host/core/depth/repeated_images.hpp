// A camera that hangs may hand out its last image again and again, with times that go on.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/time.hpp"
#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

/// The images of one camera in the order in which they come. Two images of a real camera are never equal bit
/// by bit for long: they have noise.
class RepeatedImages {
  public:
    /// So many equal images in a row may be chance, or of a device that gives each one twice.
    static constexpr unsigned kEqualMax = 5;
    static constexpr Nanoseconds kTimeMax{500'000'000};

    /// True if this image is a repetition: it equals more than kEqualMax before it, the first of which was
    /// captured over kTimeMax ago. O(pixels); keeps a copy of one image. Throws std::bad_alloc.
    bool take(const DepthFrame& frame) {
        if (frame.depth_mm != shown_) {
            shown_ = frame.depth_mm;
            since_ = frame.captured;
            lasted_ = Nanoseconds{0};
            equal_ = 0;
            has_value_ = std::ranges::any_of(shown_, [](std::uint16_t mm) { return mm != 0; });
            return false;
        }
        ++equal_;
        lasted_ = frame.captured - since_;
        return equal_ > kEqualMax && lasted_ > kTimeMax;
    }
    /// Between the first and the last image that are equal.
    [[nodiscard]] Nanoseconds lasted() const noexcept { return lasted_; }
    /// The last image has a pixel with a value: what is in front of a covered lens has none.
    [[nodiscard]] bool has_value() const noexcept { return has_value_; }

  private:
    std::vector<std::uint16_t> shown_;
    HostTime since_{0};
    Nanoseconds lasted_{0};
    std::uint64_t equal_ = 0;
    bool has_value_ = false;
};

}  // namespace octoskin
