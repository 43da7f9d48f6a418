// Detects repeated images: a camera driver that hangs can deliver its last images again with new capture
// times.
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

/// Takes the images of one camera in the order of arrival. Images of a working camera are never equal bit by
/// bit for long, because they contain noise. A driver that hangs may deliver the images of its buffer ring in
/// turn, and sometimes one that differs. Therefore two lists are kept: the last kKnownMax different images,
/// with the time of each one's first arrival, and the last kKnownMax images that were repetitions. An image
/// that differs from a known one in a few places, or is torn, also counts as known, because real noise is
/// everywhere.
class RepeatedImages {
  public:
    /// Up to this number, known images may be chance, or come from a device that delivers each image twice.
    static constexpr unsigned kEqualMax = 5;
    static constexpr Nanoseconds kTimeMax{500'000'000};
    static constexpr std::size_t kKnownMax = 16;

    /// True if this image is a repetition: it is known, it was first captured over kTimeMax ago, and more
    /// than kEqualMax known images, including this one, have come since. An image without any value recurs
    /// when the lens is covered now and then. It is a repetition only if it is in an uninterrupted row of
    /// more than kEqualMax known images, and the image before the row was captured over kTimeMax ago.
    /// O(pixels); stores only checksums.
    bool take(const DepthFrame& frame) noexcept {
        newest_ = frame.captured;
        has_value_ = std::ranges::any_of(frame.depth_mm, [](std::uint16_t mm) { return mm != 0; });
        const Print print = print_of(frame.depth_mm);
        const Image* const repeated = repeated_.find(print);
        const Image* const image = repeated != nullptr ? repeated : recent_.find(print);
        const bool is_new = image == nullptr;
        if (is_new) {
            row_ = {newest_, again_};
            recent_.add({print, row_});
        } else {
            ++again_;
        }
        const Begin& begin = is_new || !has_value_ ? row_ : image->begin;
        const bool is_repetition = newest_ - begin.at > kTimeMax && again_ - begin.again > kEqualMax;
        if (is_repetition && has_value_ && repeated == nullptr) repeated_.add(*image);
        weigh(is_new, is_repetition);
        return is_repetition;
    }
    /// The camera was reopened. Known images are kept, because a camera that hangs may continue with them.
    void begin_opening() noexcept { opening_since_.reset(); }

    /// For how long the camera has delivered known images since it was opened, with only occasional new ones,
    /// up to the newest image; 0 if the newest image is new.
    [[nodiscard]] Nanoseconds lasted() const noexcept {
        return opening_since_ && again_ > row_.again ? newest_ - *opening_since_ : Nanoseconds{0};
    }
    /// More than a third of the newest images are repetitions.
    [[nodiscard]] bool are_many() const noexcept { return weight_ >= kMany; }
    /// The last image has a pixel with a value. With a covered lens it has none.
    [[nodiscard]] bool has_value() const noexcept { return has_value_; }

  private:
    static constexpr std::size_t kAtOnce = sizeof(std::uint64_t) / sizeof(std::uint16_t);
    static constexpr std::size_t kParts = 16;
    static constexpr std::size_t kRoughPartsMin = 4;
    static constexpr unsigned kRoughMin = 64;  ///< noise seldom leaves as many unchanged
    static constexpr int kMany = 6;
    static constexpr int kWeightMax = 12;
    struct Begin {
        HostTime at{0};
        std::uint64_t again = 0;  ///< number of known images up to that time
    };
    /// What is stored of an image: a checksum of each part, and whether the part is rough.
    struct Print {
        std::array<std::uint64_t, kParts> sums{};
        std::array<bool, kParts> is_rough{};
    };
    struct Image {
        Print print;
        Begin begin;
    };
    /// Up to kKnownMax images, the most recent one first.
    class Images {
      public:
        /// Returns null if the image is not in the list.
        const Image* find(const Print& print) noexcept {
            const auto end = images_.begin() + static_cast<std::ptrdiff_t>(count_);
            const auto at = std::find_if(images_.begin(), end,
                                         [&](const Image& one) { return are_one(one.print, print); });
            if (at == end) return nullptr;
            std::rotate(images_.begin(), at, at + 1);
            return images_.data();
        }
        /// Replaces the least recent image if the list is full.
        void add(const Image& image) noexcept {
            std::shift_right(images_.begin(), images_.end(), 1);
            images_.front() = image;
            count_ = std::min(count_ + 1, kKnownMax);
        }

      private:
        std::array<Image, kKnownMax> images_{};
        std::size_t count_ = 0;
    };

    /// One repetition outweighs two new images: while a camera hangs there are few or no new ones.
    void weigh(bool is_new, bool is_repetition) noexcept {
        if (!opening_since_ || (is_new && weight_ == 0)) opening_since_ = newest_;
        if (is_repetition) weight_ = std::min(weight_ + 2, kWeightMax);
        if (is_new) weight_ = std::max(weight_ - 1, 0);
    }

    /// True if all parts are equal, or at least half of the parts that are rough in one of the two.
    static bool are_one(const Print& a, const Print& b) noexcept {
        std::size_t equal = 0;
        std::size_t rough = 0;
        std::size_t rough_equal = 0;
        for (std::size_t part = 0; part < kParts; ++part) {
            const bool is_equal = a.sums[part] == b.sums[part];
            const bool is_rough = a.is_rough[part] || b.is_rough[part];
            equal += is_equal ? 1 : 0;
            rough += is_rough ? 1 : 0;
            rough_equal += is_rough && is_equal ? 1 : 0;
        }
        return equal == kParts || (rough >= kRoughPartsMin && 2 * rough_equal >= rough);
    }
    static Print print_of(std::span<const std::uint16_t> pixels) noexcept {
        Print print;
        const std::size_t size = (pixels.size() / kParts + kAtOnce) / kAtOnce * kAtOnce;  // pixels of a part
        for (std::size_t part = 0; part < kParts; ++part) {
            const auto some = pixels.first(std::min(size, pixels.size()));
            print.sums[part] = checksum(some);
            print.is_rough[part] = is_rough(some);
            pixels = pixels.subspan(some.size());
        }
        return print;
    }
    /// True if at least kRoughMin pixels differ from the pixel before, where both have a value. Values that a
    /// camera fills in for a missing return, and a wall without noise, are not rough.
    static bool is_rough(std::span<const std::uint16_t> pixels) noexcept {
        unsigned changes = 0;
        for (std::size_t i = 1; i < pixels.size(); ++i) {
            const unsigned before = pixels[i - 1];
            const unsigned here = pixels[i];
            changes += static_cast<unsigned>(before != here) & static_cast<unsigned>(before != 0) &
                       static_cast<unsigned>(here != 0);
        }
        return changes >= kRoughMin;
    }
    /// Parts that differ in one aligned group of kAtOnce pixels always have different checksums; other
    /// differing parts nearly always.
    static std::uint64_t checksum(std::span<const std::uint16_t> pixels) noexcept {
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

    Images recent_;
    Images repeated_;          ///< repetitions with a value
    std::uint64_t again_ = 0;  ///< number of images that were known on arrival
    Begin row_;                ///< the image before the current row of known images
    /// The last new image before those that repeat, or the first image.
    std::optional<HostTime> opening_since_;
    int weight_ = 0;  ///< weight of repetitions less that of new images, 0 to kWeightMax
    HostTime newest_{0};
    bool has_value_ = false;
};

}  // namespace octoskin
