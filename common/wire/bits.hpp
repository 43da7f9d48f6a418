// Bit fields in a byte buffer, numbered linearly: bit n is bit n % 8 of byte n / 8, and a field's least
// significant bit comes first. A DBC calls this Intel byte order.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

namespace octoskin::wire {

/// Largest value of an unsigned field.
[[nodiscard]] constexpr std::uint64_t max_of_bits(unsigned bits) noexcept {
    return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

/// Writes fields one after the other into zeroed bytes. Running out of room and a value wider than its field
/// are programmer's errors (asserted).
class BitWriter {
  public:
    constexpr explicit BitWriter(std::span<std::uint8_t> zeroed) noexcept : bytes_(zeroed) {}

    constexpr void put(std::uint64_t value, unsigned bits) noexcept {
        assert(value <= max_of_bits(bits));
        assert(position_ + bits <= bytes_.size() * 8);
        while (bits > 0) {
            const unsigned offset = position_ % 8;
            const unsigned taken = std::min(8 - offset, bits);
            const auto part = static_cast<unsigned>(value & max_of_bits(taken));
            bytes_[position_ / 8] = static_cast<std::uint8_t>(bytes_[position_ / 8] | (part << offset));
            value >>= taken;
            position_ += taken;
            bits -= taken;
        }
    }
    [[nodiscard]] constexpr std::size_t bits_used() const noexcept { return position_; }

  private:
    std::span<std::uint8_t> bytes_;
    unsigned position_ = 0;
};

/// Reads fields one after the other. Reading past the end is a programmer's error (asserted): the caller
/// checks the length first.
class BitReader {
  public:
    constexpr explicit BitReader(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

    [[nodiscard]] constexpr std::uint64_t get(unsigned bits) noexcept {
        assert(bits <= bits_left());
        std::uint64_t value = 0;
        for (unsigned done = 0; done < bits;) {
            const unsigned offset = position_ % 8;
            const unsigned taken = std::min(8 - offset, bits - done);
            value |= ((std::uint64_t{bytes_[position_ / 8]} >> offset) & max_of_bits(taken)) << done;
            position_ += taken;
            done += taken;
        }
        return value;
    }
    [[nodiscard]] constexpr std::size_t bits_used() const noexcept { return position_; }
    [[nodiscard]] constexpr std::size_t bits_left() const noexcept { return bytes_.size() * 8 - position_; }

  private:
    std::span<const std::uint8_t> bytes_;
    unsigned position_ = 0;
};

}  // namespace octoskin::wire
