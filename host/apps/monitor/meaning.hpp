// A key of the status: the type and the unit of its value, and its meaning for the person at the screen.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace octoskin {

enum class ValueKind : std::uint8_t {
    number,
    integer,  ///< a whole number that is no count: an id, an index
    count,    ///< a whole number, 0 or more
    flag,
    word,  ///< a text, one of a few without blanks
    text,
    list,
    table,  ///< an object of JSON
};

/// The kind as the reference page has it.
[[nodiscard]] constexpr std::string_view name_of(ValueKind kind) noexcept {
    switch (kind) {
        case ValueKind::number:
            return "number";
        case ValueKind::integer:
            return "integer";
        case ValueKind::count:
            return "count";
        case ValueKind::flag:
            return "flag";
        case ValueKind::word:
            return "word";
        case ValueKind::text:
            return "text";
        case ValueKind::list:
            return "list";
        case ValueKind::table:
            return "table";
    }
    return {};
}

struct ValueType {
    ValueKind kind;
    bool may_be_null = false;
};

struct Meaning {
    std::string_view group;  ///< what it belongs to
    std::string_view name;
    ValueType type;
    std::string_view unit;  ///< empty: it has none
    std::string_view text;
};

/// The text of `name` in `group`; empty if there is none. O(meanings).
[[nodiscard]] constexpr std::string_view find_meaning(std::span<const Meaning> meanings,
                                                      std::string_view group,
                                                      std::string_view name) noexcept {
    for (const Meaning& meaning : meanings)
        if (meaning.group == group && meaning.name == name) return meaning.text;
    return {};
}

}  // namespace octoskin
