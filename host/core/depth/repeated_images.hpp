// A camera that hangs may hand out its last images again and again, with times that go on.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include "common/time.hpp"
#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

/// The images of one camera in the order in which they come. Two images of a real camera are never equal bit
/// by bit for long: they have noise. A driver that hangs may give the images of its ring of buffers by turns:
/// so an image is known if it equals any of the last kKnownMax different ones.
class RepeatedImages {
  public:
    /// So many known images in a row may be chance, or of a device that gives each one twice.
    static constexpr unsigned kEqualMax = 5;
    static constexpr Nanoseconds kTimeMax{500'000'000};
    static constexpr std::size_t kKnownMax = 8;

    /// True if this image is a repetition: it is one of more than kEqualMax known ones in a row, and the
    /// image before that row was captured over kTimeMax ago. O(pixels); keeps checksums alone.
    bool take(const DepthFrame& frame) noexcept {
        const std::uint64_t sum = checksum(frame.depth_mm);
        has_value_ = std::ranges::any_of(frame.depth_mm, [](std::uint16_t mm) { return mm != 0; });
        newest_ = frame.captured;
        const auto end = known_.begin() + static_cast<std::ptrdiff_t>(std::min(different_, kKnownMax));
        const bool is_known = std::find(known_.begin(), end, sum) != end;
        if (!is_known) {
            known_[different_++ % kKnownMax] = sum;
            since_ = newest_;
            opening_since_ = newest_;
            equal_ = 0;
            return false;
        }
        if (!opening_since_) opening_since_ = newest_;
        ++equal_;
        return equal_ > kEqualMax && newest_ - since_ > kTimeMax;
    }
    /// The camera is opened anew: what it showed before is known still, as one that hangs may go on with it.
    void begin_opening() noexcept { opening_since_.reset(); }

    /// How long this opening has shown none but known images, up to the newest.
    [[nodiscard]] Nanoseconds lasted() const noexcept {
        return opening_since_ ? newest_ - *opening_since_ : Nanoseconds{0};
    }
    /// The last image has a pixel with a value: what is in front of a covered lens has none.
    [[nodiscard]] bool has_value() const noexcept { return has_value_; }

  private:
    /// Of images that differ in one aligned group of four pixels it always differs; of others nearly so.
    static std::uint64_t checksum(std::span<const std::uint16_t> pixels) noexcept {
        constexpr std::size_t kAtOnce = sizeof(std::uint64_t) / sizeof(std::uint16_t);
        std::uint64_t sum = pixels.size();
        while (!pixels.empty()) {
            const auto some = pixels.first(std::min(kAtOnce, pixels.size()));
            std::uint64_t word = 0;
            std::memcpy(&word, some.data(), some.size_bytes());
            sum = (sum ^ word) * 0x9E3779B97F4A7C15;  // odd: no two sums become one
            sum ^= sum >> 32U;
            pixels = pixels.subspan(some.size());
        }
        return sum;
    }

    std::array<std::uint64_t, kKnownMax> known_{};  ///< the newest of them, in no order
    std::size_t different_ = 0;                     ///< images that were not known
    std::uint64_t equal_ = 0;                       ///< known ones in a row
    HostTime since_{0};                             ///< the image before that row
    std::optional<HostTime> opening_since_;         ///< that image, or the first of this opening
    HostTime newest_{0};
    bool has_value_ = false;
};

}  // namespace octoskin
