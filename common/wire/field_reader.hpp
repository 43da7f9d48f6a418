// The walker that decodes: see layout.hpp. It reads all fields before its errors are evaluated, so that
// padding is judged before field ranges, wherever the two lie.
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

class FieldReader {
  public:
    static constexpr bool kFillsIn = true;

    explicit FieldReader(BitReader& bits) noexcept : bits_(bits) {}

    template <std::unsigned_integral T>
    void number(const Field& field, T& value) noexcept {
        const std::uint64_t raw = bits_.get(field.bits);
        has_invalid_field_ |= raw < field.min || raw > field.max;
        value = static_cast<T>(raw);
    }
    template <std::signed_integral T>
    void number(const Field& field, T& value) noexcept {
        assert(field.bits > 0);
        const std::uint64_t raw = bits_.get(field.bits);
        const std::uint64_t sign = std::uint64_t{1} << (field.bits - 1);
        // Flipping the sign bit and subtracting its weight extends the sign into all higher bits.
        value = static_cast<T>(static_cast<std::int64_t>(raw ^ sign) - static_cast<std::int64_t>(sign));
    }
    template <std::unsigned_integral T>
    void saturated(const Field& field, T& value) noexcept {
        number(field, value);
    }
    void rounded_up(const Field& field, std::uint16_t& quarter_mm) noexcept {
        quarter_mm = static_cast<std::uint16_t>(4 * bits_.get(field.bits));
    }
    void residue(const Field& field, TimeResidue& time) noexcept {
        const std::uint32_t step = step_us(field.unit);
        time = {.value_us = static_cast<std::uint32_t>(bits_.get(field.bits)) * step,
                .span_us = step << field.bits};
    }
    template <class E>
    void choice(const Field& field, E& value) noexcept {
        value = static_cast<E>(bits_.get(field.bits));
        has_invalid_field_ |= !is_known(value);
    }
    void flag(const Field& field, bool& value) noexcept { value = bits_.get(field.bits) != 0; }
    template <std::size_t N>
    void bytes(const Field&, std::array<std::uint8_t, N>& value) noexcept {
        for (std::uint8_t& byte : value) {
            byte = static_cast<std::uint8_t>(bits_.get(8));
        }
    }
    void selector(const Field& field, std::uint8_t& kept_in_message) noexcept {
        number(field, kept_in_message);
    }
    void selector(const Field& field, const std::uint8_t&) noexcept {
        static_cast<void>(bits_.get(field.bits));
    }
    void zeros(unsigned bits) noexcept { has_nonzero_padding_ |= bits_.get(bits) != 0; }
    /// `count`, limited to the entries for which the frame has room.
    [[nodiscard]] std::uint8_t entries_present(std::uint8_t count) const noexcept {
        return static_cast<std::uint8_t>(std::min<std::size_t>(count, bits_.bits_left() / kRangeFdEntryBits));
    }

    [[nodiscard]] bool has_nonzero_padding() const noexcept { return has_nonzero_padding_; }
    [[nodiscard]] bool has_invalid_field() const noexcept { return has_invalid_field_; }

  private:
    BitReader& bits_;
    bool has_nonzero_padding_ = false;
    bool has_invalid_field_ = false;
};

}  // namespace octoskin::wire
