// Numbers to bytes and back, little-endian on every processor.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace octoskin::snapshot {

/// The unsigned integer with the same number of bits.
template <class Value>
using BitsOf = std::conditional_t<
    sizeof(Value) == 1, std::uint8_t,
    std::conditional_t<sizeof(Value) == 2, std::uint16_t,
                       std::conditional_t<sizeof(Value) == 4, std::uint32_t, std::uint64_t>>>;

/// Appends to a text.
class ByteWriter {
  public:
    explicit ByteWriter(std::string& bytes) noexcept : bytes_(bytes) {}

    /// An integer or a float, bit by bit. Throws std::bad_alloc, like the functions below.
    template <class Value>
    void put(Value value) {
        const auto bits = std::bit_cast<BitsOf<Value>>(value);
        char text[sizeof(Value)];
        for (std::size_t i = 0; i < sizeof(Value); ++i)
            text[i] = static_cast<char>(static_cast<std::uint64_t>(bits) >> (8 * i) & 0xFFU);
        bytes_.append(text, sizeof(Value));
    }
    void put_flag(bool is_set) { put(static_cast<std::uint8_t>(is_set ? 1 : 0)); }
    /// Seven bits in each byte, the lowest first; the last byte has no top bit.
    void put_count(std::uint64_t count) {
        for (; count >= 0x80U; count >>= 7U) put(static_cast<std::uint8_t>(count | 0x80U));
        put(static_cast<std::uint8_t>(count));
    }

  private:
    std::string& bytes_;
};

/// Takes values from the beginning of a text. Missing ones are 0, and from then on is_sound is false.
class ByteReader {
  public:
    explicit ByteReader(std::string_view bytes) noexcept : rest_(bytes) {}

    template <class Value>
    [[nodiscard]] Value get() noexcept {
        std::uint64_t bits = 0;
        if (rest_.size() < sizeof(Value)) {
            fail();
            return Value{};
        }
        for (std::size_t i = 0; i < sizeof(Value); ++i)
            bits |= std::uint64_t{static_cast<std::uint8_t>(rest_[i])} << (8 * i);
        rest_.remove_prefix(sizeof(Value));
        return std::bit_cast<Value>(static_cast<BitsOf<Value>>(bits));
    }
    [[nodiscard]] bool get_flag() noexcept {
        const auto flag = get<std::uint8_t>();
        if (flag > 1) fail();
        return flag == 1;
    }
    [[nodiscard]] std::uint64_t get_count() noexcept {
        std::uint64_t count = 0;
        for (unsigned shift = 0; shift < 63; shift += 7) {
            const auto byte = get<std::uint8_t>();
            count |= std::uint64_t{byte & 0x7FU} << shift;
            if (byte < 0x80U) return count;
        }
        fail();
        return 0;
    }
    /// Marks the input as invalid.
    void fail() noexcept {
        is_sound_ = false;
        rest_ = {};
    }

    [[nodiscard]] bool is_sound() const noexcept { return is_sound_; }
    [[nodiscard]] bool is_over() const noexcept { return rest_.empty(); }

  private:
    std::string_view rest_;
    bool is_sound_ = true;
};

}  // namespace octoskin::snapshot
