// The walker that encodes: see layout.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <concepts>
#include <type_traits>

#include "common/wire/bits.hpp"
#include "common/wire/layout.hpp"
#include "common/wire/names.hpp"

namespace octoskin::wire {

class FieldWriter {
  public:
    static constexpr bool kFillsIn = false;

    explicit FieldWriter(BitWriter& bits) noexcept : bits_(bits) {}

    template <std::unsigned_integral T>
    void number(const Field& field, const T& value) noexcept {
        assert(value >= field.min && value <= field.max);
        bits_.put(value, field.bits);
    }
    /// Two's complement.
    template <std::signed_integral T>
    void number(const Field& field, const T& value) noexcept {
        const auto half = static_cast<std::int64_t>(max_of_bits(field.bits - 1));
        assert(value >= -half - 1 && value <= half);
        bits_.put(static_cast<std::uint64_t>(std::int64_t{value}) & max_of_bits(field.bits), field.bits);
    }
    void saturated(const Field& field, std::uint64_t value) noexcept {
        bits_.put(std::min(value, field.max), field.bits);
    }
    void rounded_up(const Field& field, std::uint64_t quarter_mm) noexcept {
        saturated(field, (quarter_mm + 3) / 4);
    }
    void residue(const Field& field, const TimeResidue& time) noexcept {
        const std::uint32_t step = step_us(field.unit);
        assert(time.span_us == step << field.bits);
        assert(time.value_us < time.span_us);
        bits_.put(time.value_us / step, field.bits);
    }
    template <class E>
    void choice(const Field& field, const E& value) noexcept {
        assert(is_known(value));
        bits_.put(static_cast<std::underlying_type_t<E>>(value), field.bits);
    }
    void flag(const Field& field, bool value) noexcept { bits_.put(value ? 1 : 0, field.bits); }
    template <std::size_t N>
    void bytes(const Field&, const std::array<std::uint8_t, N>& value) noexcept {
        for (const std::uint8_t byte : value) {
            bits_.put(byte, 8);
        }
    }
    void selector(const Field& field, const std::uint8_t& value) noexcept { number(field, value); }
    void zeros(unsigned bits) noexcept { bits_.put(0, bits); }
    [[nodiscard]] std::uint8_t entries_present(std::uint8_t count) const noexcept { return count; }

  private:
    BitWriter& bits_;
};

}  // namespace octoskin::wire
