// A value or the reason why there is none. The names are those of std::expected, which C++20 lacks. No heap,
// no exceptions.
#pragma once

#include <cassert>
#include <utility>
#include <variant>

namespace octoskin {

/// Wraps an error so that `return unexpected(E::x)` converts to any `Result<T, E>`.
template <class E>
struct Unexpected {
    E error;
};

template <class E>
[[nodiscard]] constexpr Unexpected<E> unexpected(E error) noexcept(noexcept(E(std::move(error)))) {
    return {std::move(error)};
}

/// Either a `T` or an `E`. Access to the one that is not held is a programmer's error (asserted).
template <class T, class E>
class [[nodiscard]] Result {
  public:
    constexpr Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    constexpr Result(Unexpected<E> failure) : state_(std::in_place_index<1>, std::move(failure.error)) {}

    [[nodiscard]] constexpr bool has_value() const noexcept { return state_.index() == 0; }
    constexpr explicit operator bool() const noexcept { return has_value(); }

    [[nodiscard]] constexpr const T& value() const& {
        assert(has_value());
        return *std::get_if<0>(&state_);
    }
    [[nodiscard]] constexpr T& value() & {
        assert(has_value());
        return *std::get_if<0>(&state_);
    }
    [[nodiscard]] constexpr T&& value() && {
        assert(has_value());
        return std::move(*std::get_if<0>(&state_));
    }
    [[nodiscard]] constexpr const T& operator*() const& { return value(); }
    [[nodiscard]] constexpr T& operator*() & { return value(); }
    [[nodiscard]] constexpr T&& operator*() && { return std::move(*this).value(); }
    [[nodiscard]] constexpr const T* operator->() const { return &value(); }
    [[nodiscard]] constexpr T* operator->() { return &value(); }

    [[nodiscard]] constexpr const E& error() const {
        assert(!has_value());
        return *std::get_if<1>(&state_);
    }

  private:
    std::variant<T, E> state_;
};

/// Success without a value, or an error.
struct Done {};
template <class E>
using Status = Result<Done, E>;

}  // namespace octoskin
