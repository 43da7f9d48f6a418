#include "host/io/openni2/helpers/packed_depth.hpp"

namespace octoskin::openni2 {
namespace {

// The encoding that OpenNI2 2.2 unpacks (Source/Drivers/OniFile/Formats/XnStreamCompression.cpp).
constexpr unsigned kRepeat = 0xE0;    // and above: `code - kRepeat` pairs of the last value
constexpr unsigned kLong = 0xFF;      // a large difference or a full value follows
constexpr unsigned kLongBehind = 15;  // in the lower half of a byte: the same
constexpr unsigned kNone = 13;        // in the lower half: no value
constexpr int kSmallZero = 6;
constexpr int kLargeZero = 192;

class Walk {
  public:
    Walk(std::span<const std::uint8_t> packed, DepthPacking packing) : left_(packed) {
        if (packing == DepthPacking::with_table) {
            values_ = take_word();
            skip(2 * values_);
        }
        go_to(take_word());
    }

    [[nodiscard]] std::optional<std::size_t> to_the_end() {
        while (is_sound_ && !left_.empty()) step(take());
        return is_sound_ ? std::optional(depths_) : std::nullopt;
    }

  private:
    void step(unsigned code) {
        if (code == kLong) return take_long();
        if (code >= kRepeat) {
            depths_ += std::size_t{2} * (code - kRepeat);
            return;
        }
        change_by(static_cast<int>(code >> 4U) - kSmallZero);
        const unsigned behind = code & 0x0FU;
        if (behind == kLongBehind) return take_long();
        if (behind != kNone) change_by(static_cast<int>(behind) - kSmallZero);
    }
    void take_long() {
        const unsigned first = take();
        if ((first & 0x80U) != 0) return change_by(static_cast<int>(first) - kLargeZero);
        go_to(first << 8U | take());
    }
    void change_by(int difference) {
        go_to(static_cast<std::uint16_t>(static_cast<int>(value_) - difference));
    }
    void go_to(unsigned value) {
        value_ = value;
        is_sound_ = is_sound_ && value < values_;
        ++depths_;
    }

    unsigned take() {
        if (left_.empty()) {
            is_sound_ = false;
            return 0;
        }
        const unsigned byte = left_.front();
        left_ = left_.subspan(1);
        return byte;
    }
    unsigned take_word() {
        const unsigned low = take();
        return low | take() << 8U;
    }
    void skip(std::size_t count) {
        is_sound_ = is_sound_ && count <= left_.size();
        left_ = is_sound_ ? left_.subspan(count) : left_.first(0);
    }

    std::span<const std::uint8_t> left_;
    unsigned values_ = 1U << 16U;  ///< number of selectable values
    unsigned value_ = 0;
    std::size_t depths_ = 0;
    bool is_sound_ = true;
};

}  // namespace

std::optional<std::size_t> depths_in(std::span<const std::uint8_t> packed, DepthPacking packing) {
    return Walk(packed, packing).to_the_end();
}

}  // namespace octoskin::openni2
