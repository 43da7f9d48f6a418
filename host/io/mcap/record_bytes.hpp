// Fields of an MCAP record to bytes and back: little-endian integers, texts with their length before them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>

namespace octoskin::mcap {

using Metadata = std::map<std::string, std::string>;

/// Appends fields to a text. Every function throws std::bad_alloc.
class FieldWriter {
  public:
    explicit FieldWriter(std::string& bytes) noexcept : bytes_(bytes) {}

    template <class Value>
    void put(Value value) {
        static_assert(std::is_unsigned_v<Value>);
        for (std::size_t i = 0; i < sizeof(Value); ++i)
            bytes_ += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xFFU);
    }
    /// A text or bytes, with their length in 32 bits.
    void put_text(std::string_view text) {
        put(static_cast<std::uint32_t>(text.size()));
        bytes_ += text;
    }
    void put_metadata(const Metadata& metadata) {
        std::string entries;
        FieldWriter writer(entries);
        for (const auto& [key, value] : metadata) {
            writer.put_text(key);
            writer.put_text(value);
        }
        put_text(entries);
    }

  private:
    std::string& bytes_;
};

/// Takes fields from the beginning of a record. Missing ones are 0 or empty, and from then on is_sound is
/// false.
class FieldReader {
  public:
    explicit FieldReader(std::string_view bytes) noexcept : rest_(bytes) {}

    template <class Value>
    [[nodiscard]] Value get() noexcept {
        static_assert(std::is_unsigned_v<Value>);
        const std::string_view bytes = take(sizeof(Value));
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes.size(); ++i)
            value |= std::uint64_t{static_cast<std::uint8_t>(bytes[i])} << (8 * i);
        return static_cast<Value>(value);
    }
    [[nodiscard]] std::string_view take(std::uint64_t count) noexcept {
        if (count > rest_.size()) {
            is_sound_ = false;
            rest_ = {};
            return {};
        }
        const std::string_view taken = rest_.substr(0, static_cast<std::size_t>(count));
        rest_.remove_prefix(taken.size());
        return taken;
    }
    [[nodiscard]] std::string_view get_text() noexcept { return take(get<std::uint32_t>()); }

    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }
    [[nodiscard]] bool is_sound() const noexcept { return is_sound_; }

  private:
    std::string_view rest_;
    bool is_sound_ = true;
};

}  // namespace octoskin::mcap
