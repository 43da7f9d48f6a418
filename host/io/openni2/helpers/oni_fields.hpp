// Reads the fields of an .oni record one after another.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

namespace octoskin::openni2 {

class OniFields {
  public:
    explicit OniFields(std::span<const std::uint8_t> bytes) : left_(bytes) {}

    /// Empty if there are not enough bytes.
    template <class T>
    [[nodiscard]] std::optional<T> take() {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto bytes = take_bytes(sizeof(T));
        if (!bytes) return std::nullopt;
        T value{};
        std::memcpy(&value, bytes->data(), sizeof(T));
        return value;
    }
    [[nodiscard]] std::optional<std::span<const std::uint8_t>> take_bytes(std::size_t count) {
        if (count > left_.size()) return std::nullopt;
        const auto bytes = left_.first(count);
        left_ = left_.subspan(count);
        return bytes;
    }
    /// A length and so many characters: printable ASCII (OpenNI2 uses other values as indices before a table)
    /// with a NUL at the end; empty otherwise.
    [[nodiscard]] std::optional<std::string_view> take_text() {
        const auto length = take<std::uint32_t>();
        const auto bytes = length ? take_bytes(*length) : std::nullopt;
        if (!bytes || bytes->empty()) return std::nullopt;
        const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
        const std::string_view characters = text.substr(0, text.size() - 1);
        const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
        if (text.back() != '\0' || !std::ranges::all_of(characters, is_printable)) return std::nullopt;
        return characters;
    }
    [[nodiscard]] bool are_at_end() const noexcept { return left_.empty(); }

  private:
    std::span<const std::uint8_t> left_;
};

}  // namespace octoskin::openni2
