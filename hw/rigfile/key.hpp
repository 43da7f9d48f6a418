// Declarations of the keys of a YAML file: the name of a key, the values that it accepts, and the value that
// holds without it. The parser, the canonical writer and the tables of the reference pages use them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/config/node_config.hpp"

namespace octoskin::rig {

/// The least and the greatest value allowed.
template <class T>
struct Range {
    T min;
    T max;
};

/// The effect of a missing key. Without a value and without a text the key is required.
template <class T>
struct Default {
    std::optional<T> value = {};
    std::string_view text = "required";  ///< for the reference page, unless there is a value
};
/// Of a key whose default is not a value of its own: "none", "the whole array".
using NoDefault = Default<std::monostate>;

// The members that all kinds of keys have:
// `path`: "nodes[].sensors[].address"; the name is its last part. A path that ends in `[]` or `{}` declares
// each item of that list or each value of that table.
// `meaning`: Markdown of one line; its links start from docs/.
// `is_in_node_block`: the value is in the configuration block of a node.

struct NumberKey {
    std::string_view path;
    std::string_view unit = {};
    Range<double> range;
    Default<double> fallback = {};
    std::string_view meaning;
    bool is_in_node_block = false;
};

struct IntegerKey {
    std::string_view path;
    std::string_view unit = {};
    Range<std::int64_t> range;                  ///< another number is a wrong type or unit
    std::span<const std::int64_t> values = {};  ///< not empty: of the range only these
    Default<std::int64_t> fallback = {};
    std::string_view meaning;
    bool is_in_node_block = false;
};

struct FlagKey {
    std::string_view path;
    Default<bool> fallback = {};
    std::string_view meaning;
    bool is_in_node_block = false;
};

/// One of a few words.
template <class Enum>
struct WordKey {
    std::string_view path;
    std::span<const std::pair<std::string_view, Enum>> words;
    Default<Enum> fallback = {};
    std::string_view meaning;
    bool is_in_node_block = false;
};

enum class TextKind : std::uint8_t {
    name,          ///< Table::name()
    folder_name,   ///< Table::folder_name()
    element_name,  ///< Table::element_name()
    path,          ///< of a file, relative to the file that has the key
};
struct TextKey {
    std::string_view path;
    TextKind kind = TextKind::name;
    NoDefault fallback = {};
    std::string_view meaning;
    bool is_in_node_block = false;
};

/// A list of `count` numbers: a position, an orientation.
struct NumbersKey {
    std::string_view path;
    std::string_view unit = {};
    std::size_t count = 3;
    Range<double> range;
    NoDefault fallback = {};
    std::string_view meaning;
    bool is_in_node_block = false;
};

inline constexpr std::size_t kAnyCount = std::numeric_limits<std::size_t>::max();
struct ListKey {
    std::string_view path;
    std::string_view items;  ///< in the plural: "nodes"
    Range<std::size_t> count = {0, kAnyCount};
    NoDefault fallback = {};
    std::string_view meaning;
    bool is_in_node_block = false;
};

/// A table with keys of its own, or a value of no other kind.
struct TableKey {
    std::string_view path;
    std::string_view expected = "a table";  ///< Markdown
    NoDefault fallback = {};
    std::string_view meaning;
    bool is_in_node_block = false;
};

enum class JointWay : std::uint8_t;

using AnyKey =
    std::variant<const NumberKey*, const IntegerKey*, const FlagKey*, const WordKey<bool>*,
                 const WordKey<DistanceMode>*, const WordKey<StreamGate>*, const WordKey<JointWay>*,
                 const TextKey*, const NumbersKey*, const ListKey*, const TableKey*>;

/// All keys of one table of a file. Their order is that of the hints about an unknown key.
struct KeyTable {
    std::string_view title;  ///< of the table on the reference page; several may be one table there
    std::span<const AnyKey> keys;
};

/// "address" of "nodes[].sensors[].address".
[[nodiscard]] constexpr std::string_view name_of(std::string_view path) noexcept {
    if (path.ends_with("[]") || path.ends_with("{}")) path.remove_suffix(2);
    return path.substr(path.rfind('.') + 1);  // npos + 1 is 0
}
template <class Key>
concept DeclaredKey = requires(const Key& key) {
    key.path;
    key.fallback;
};
[[nodiscard]] constexpr std::string_view name_of(const DeclaredKey auto& key) noexcept {
    return name_of(key.path);
}
[[nodiscard]] std::string_view path_of(const AnyKey& key) noexcept;
[[nodiscard]] std::string_view unit_of(const AnyKey& key) noexcept;
[[nodiscard]] std::string_view meaning_of(const AnyKey& key) noexcept;
[[nodiscard]] bool is_in_node_block(const AnyKey& key) noexcept;
[[nodiscard]] std::vector<std::string_view> names_of(const KeyTable& table);

/// The values that the parser accepts: "a number from 0 to 1", "true or false", "2v8 or 1v8".
[[nodiscard]] std::string expected_text(const AnyKey& key);
/// "required", a value as the canonical text has it, or the effect of the missing key.
[[nodiscard]] std::string default_text(const AnyKey& key);

/// The word for a value, which must be among the words of the key.
template <class Enum>
[[nodiscard]] constexpr std::string_view word_of(const WordKey<Enum>& key, Enum value) noexcept {
    std::string_view word;
    for (const auto& [text, meaning] : key.words)
        if (meaning == value) word = text;
    return word;
}

}  // namespace octoskin::rig
