// Strict access to a table of the rig file: every key known, every value of its type and within its range.
// Each function throws Error with file, line and key, the expected and the found value, and the remedy.
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/key.hpp"

namespace octoskin::rig {

/// Throws `error` at the file and line of `value`, with the key `path`.
[[noreturn]] void fail(const Value& value, const std::string& path, Error error);

[[nodiscard]] double read_number(const Value& value, const std::string& path, Range<double> range);
[[nodiscard]] std::int64_t read_integer(const Value& value, const std::string& path,
                                        Range<std::int64_t> range);
/// Any unsigned 64-bit number.
[[nodiscard]] std::uint64_t read_unsigned(const Value& value, const std::string& path);
/// Any scalar in UTF-8, as it is written.
[[nodiscard]] std::string read_text(const Value& value, const std::string& path);
/// A name: 1..64 letters, digits and _ - . /
[[nodiscard]] std::string read_name(const Value& value, const std::string& path);
/// A name of an element in a robot description or a world: 1..256 bytes of UTF-8 without control characters.
/// Blanks and colons are allowed.
[[nodiscard]] std::string read_element_name(const Value& value, const std::string& path);
[[nodiscard]] const std::vector<Value>& read_list(const Value& value, const std::string& path);

class Table {
  public:
    /// `path`: where the table is, "nodes[0].sensors[3]"; empty at the top. Refuses a value that is no table
    /// and any key that is not in `known_keys`, with a hint if the unit in its name is the only difference,
    /// or if it belongs further down: `keys_below`, whole paths as "map.resolution_m".
    Table(const Value& value, std::string path, std::span<const std::string_view> known_keys,
          std::span<const std::string> keys_below = {});
    Table(const Value& value, std::string path, std::initializer_list<std::string_view> known_keys,
          std::span<const std::string> keys_below = {})
        : Table(value, std::move(path), std::span(known_keys.begin(), known_keys.size()), keys_below) {}
    /// The keys that are declared for it.
    Table(const Value& value, std::string path, const KeyTable& declared);

    [[nodiscard]] const Value& value() const noexcept { return value_; }
    [[nodiscard]] std::string path_of(std::string_view key) const;
    /// nullptr if the key is absent or null.
    [[nodiscard]] const Value* find(std::string_view key) const noexcept;
    [[nodiscard]] const Value& require(std::string_view key) const;

    /// The same by a declared key.
    [[nodiscard]] std::string path_of(const DeclaredKey auto& key) const { return path_of(name_of(key)); }
    [[nodiscard]] const Value* find(const DeclaredKey auto& key) const noexcept { return find(name_of(key)); }
    [[nodiscard]] const Value& require(const DeclaredKey auto& key) const { return require(name_of(key)); }
    [[noreturn]] void fail(const DeclaredKey auto& key, Error error) const {
        fail(name_of(key), std::move(error));
    }

    /// The value of a declared key; its default if it is absent and has one.
    [[nodiscard]] double number(const NumberKey& key) const { return number(key, key.range); }
    template <std::integral T>
    [[nodiscard]] T integer(const IntegerKey& key) const {
        return integer<T>(key, key.range);
    }
    /// The same with a range that lies within the declared one, for a limit that depends on another value.
    [[nodiscard]] double number(const NumberKey& key, Range<double> within) const {
        return number(name_of(key), within, key.fallback.value);
    }
    template <std::integral T>
    [[nodiscard]] T integer(const IntegerKey& key, Range<std::int64_t> within) const {
        return static_cast<T>(integer<std::int64_t>(name_of(key), within, key.fallback.value));
    }
    [[nodiscard]] bool flag(const FlagKey& key) const { return flag(name_of(key), key.fallback.value); }
    template <class Enum>
    [[nodiscard]] Enum choice(const WordKey<Enum>& key) const {
        return choice(name_of(key), key.words, key.fallback.value);
    }
    /// As its kind wants it. A path as it is written, any text.
    [[nodiscard]] std::string text(const TextKey& key) const;
    /// Of any length.
    [[nodiscard]] const std::vector<Value>& list(const ListKey& key) const;

    [[nodiscard]] double number(std::string_view key, Range<double> range,
                                std::optional<double> fallback = std::nullopt) const;
    template <std::integral T>
    [[nodiscard]] T integer(std::string_view key, Range<std::int64_t> range,
                            std::optional<T> fallback = std::nullopt) const {
        if (!find(key) && fallback) return *fallback;
        return static_cast<T>(read_integer(require(key), path_of(key), range));
    }
    [[nodiscard]] bool flag(std::string_view key, std::optional<bool> fallback = std::nullopt) const;
    [[nodiscard]] std::uint64_t unsigned_integer(std::string_view key, std::uint64_t fallback) const;
    [[nodiscard]] std::string name(std::string_view key) const;
    [[nodiscard]] std::string element_name(std::string_view key) const;
    /// A name() that is a safe path component: without `/` and `..`, and not `.`.
    [[nodiscard]] std::string folder_name(std::string_view key) const;
    /// read_text(); empty if the key is absent.
    [[nodiscard]] std::string text(std::string_view key) const;
    /// One of a few words.
    template <class Enum>
    [[nodiscard]] Enum choice(std::string_view key, std::span<const std::pair<std::string_view, Enum>> words,
                              std::optional<Enum> fallback = std::nullopt) const {
        if (!find(key) && fallback) return *fallback;
        std::string expected;
        for (const auto& [word, meaning] : words) {
            if (require(key).kind == Value::Kind::scalar && require(key).text == word) return meaning;
            expected += (expected.empty() ? "" : " or ") + std::string(word);
        }
        fail_choice(key, expected);
    }
    template <class Enum>
    [[nodiscard]] Enum choice(std::string_view key,
                              std::initializer_list<std::pair<std::string_view, Enum>> words,
                              std::optional<Enum> fallback = std::nullopt) const {
        return choice(key, std::span(words.begin(), words.size()), fallback);
    }
    [[noreturn]] void fail(std::string_view key, Error error) const;

  private:
    [[noreturn]] void fail_choice(std::string_view key, const std::string& expected) const;

    const Value& value_;
    std::string path_;
};

/// Description of a found value for a message: the text of a scalar, or "a list of 3" and the like.
[[nodiscard]] std::string describe(const Value& value);

}  // namespace octoskin::rig
