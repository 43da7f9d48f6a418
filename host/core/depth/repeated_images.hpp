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
/// by bit for long: they have noise. A driver that hangs may give the images of its ring of buffers by turns,
/// and now and then one that differs: so each of the last kKnownMax different images is known, with when it
/// first came, and each of the last kKnownMax that were repetitions, whatever comes between. One that differs
/// in a few places, or is torn, is known, too: in a real one noise is everywhere.
class RepeatedImages {
  public:
    /// So many images that were known may be chance, or of a device that gives each one twice.
    static constexpr unsigned kEqualMax = 5;
    static constexpr Nanoseconds kTimeMax{500'000'000};
    static constexpr std::size_t kKnownMax = 16;

    /// True if this image is a repetition: it is known, was first captured over kTimeMax ago, and with it
    /// more than kEqualMax known ones came since. One without any value comes again and again from a lens
    /// that is covered now and then: it is a repetition only as one of more than kEqualMax known ones in a
    /// row, with the image before that row captured over kTimeMax ago. O(pixels); keeps checksums alone.
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
    /// The camera is opened anew: what it showed before is known still, as one that hangs may go on with it.
    void begin_opening() noexcept { opening_since_.reset(); }

    /// How long this opening has shown known images, with new ones among them at most now and then, up to
    /// the newest, which is known; else 0.
    [[nodiscard]] Nanoseconds lasted() const noexcept {
        return opening_since_ && again_ > row_.again ? newest_ - *opening_since_ : Nanoseconds{0};
    }
    /// Of the newest images more than a third are repetitions.
    [[nodiscard]] bool are_many() const noexcept { return weight_ >= kMany; }
    /// The last image has a pixel with a value: what is in front of a covered lens has none.
    [[nodiscard]] bool has_value() const noexcept { return has_value_; }

  private:
    static constexpr std::size_t kAtOnce = sizeof(std::uint64_t) / sizeof(std::uint16_t);
    static constexpr std::size_t kParts = 16;
    static constexpr std::size_t kRoughPartsMin = 4;
    static constexpr unsigned kRoughMin = 64;  ///< noise hardly leaves so many as they were
    static constexpr int kMany = 6;
    static constexpr int kWeightMax = 12;
    struct Begin {
        HostTime at{0};
        std::uint64_t again = 0;  ///< known images that had come by then
    };
    /// What is kept of an image: of each of its parts a checksum, and whether it is rough.
    struct Print {
        std::array<std::uint64_t, kParts> sums{};
        std::array<bool, kParts> is_rough{};
    };
    struct Image {
        Print print;
        Begin begin;
    };
    /// kKnownMax images, the one that came last first.
    class Images {
      public:
        /// Null if it is not there.
        const Image* find(const Print& print) noexcept {
            const auto end = images_.begin() + static_cast<std::ptrdiff_t>(count_);
            const auto at = std::find_if(images_.begin(), end,
                                         [&](const Image& one) { return are_one(one.print, print); });
            if (at == end) return nullptr;
            std::rotate(images_.begin(), at, at + 1);
            return images_.data();
        }
        /// In place of the one that came least recently.
        void add(const Image& image) noexcept {
            std::shift_right(images_.begin(), images_.end(), 1);
            images_.front() = image;
            count_ = std::min(count_ + 1, kKnownMax);
        }

      private:
        std::array<Image, kKnownMax> images_{};
        std::size_t count_ = 0;
    };

    /// A repetition outweighs two new images: of those there are none while a camera hangs, or a few.
    void weigh(bool is_new, bool is_repetition) noexcept {
        if (!opening_since_ || (is_new && weight_ == 0)) opening_since_ = newest_;
        if (is_repetition) weight_ = std::min(weight_ + 2, kWeightMax);
        if (is_new) weight_ = std::max(weight_ - 1, 0);
    }

    /// To the last bit, or in at least half of the parts that are rough in one of them.
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
        const std::size_t size = (pixels.size() / kParts + kAtOnce) / kAtOnce * kAtOnce;  // of a part
        for (std::size_t part = 0; part < kParts; ++part) {
            const auto some = pixels.first(std::min(size, pixels.size()));
            print.sums[part] = checksum(some);
            print.is_rough[part] = is_rough(some);
            pixels = pixels.subspan(some.size());
        }
        return print;
    }
    /// kRoughMin pixels differ from the one before; neither lacks a value. So what a camera may fill in for
    /// no return, and a wall without noise, is not rough.
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
    /// Of parts that differ in one aligned group of kAtOnce pixels it always differs; of others nearly so.
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
    Images repeated_;                        ///< those with a value
    std::uint64_t again_ = 0;                ///< images that were known as they came
    Begin row_;                              ///< of the row of known ones: the image before it
    std::optional<HostTime> opening_since_;  ///< the last new image before those that repeat, or the first
    int weight_ = 0;                         ///< of repetitions less that of new ones, 0 to kWeightMax
    HostTime newest_{0};
    bool has_value_ = false;
};

}  // namespace octoskin
