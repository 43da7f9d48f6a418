#include "hw/rigfile/key.hpp"

#include <fmt/format.h>

#include <type_traits>

#include "hw/rigfile/joined.hpp"

namespace octoskin::rig {
namespace {

std::string accepted(const NumberKey& key) {
    return fmt::format("a number from {} to {}", key.range.min, key.range.max);
}

std::string accepted(const IntegerKey& key) {
    if (!key.values.empty()) return "one of " + joined(key.values);
    return fmt::format("a whole number from {} to {}", key.range.min, key.range.max);
}

std::string accepted(const FlagKey&) {
    return "true or false";
}

template <class Enum>
std::string accepted(const WordKey<Enum>& key) {
    std::string text;
    for (const auto& entry : key.words) text += (text.empty() ? "" : " or ") + std::string(entry.first);
    return text;
}

std::string accepted(const TextKey& key) {
    switch (key.kind) {
        case TextKind::name:
        case TextKind::folder_name:
            return "a name";
        case TextKind::element_name:
            return "the name of a link or model";
        case TextKind::path:
            break;
    }
    return "a path";
}

std::string accepted(const NumbersKey& key) {
    return fmt::format("{} numbers from {} to {}", key.count, key.range.min, key.range.max);
}

std::string accepted(const ListKey& key) {
    if (key.count.max == kAnyCount) return fmt::format("a list of {}", key.items);
    if (key.count.min == 0) return fmt::format("a list of up to {} {}", key.count.max, key.items);
    return fmt::format("a list of {} to {} {}", key.count.min, key.count.max, key.items);
}

std::string accepted(const TableKey& key) {
    return std::string(key.expected);
}

template <class Key>
std::string fallback_text(const Key& key) {
    if (!key.fallback.value) return std::string(key.fallback.text);
    if constexpr (requires { key.words; })
        return std::string(word_of(key, *key.fallback.value));
    else if constexpr (!std::is_same_v<decltype(key.fallback), NoDefault>)
        return fmt::format("{}", *key.fallback.value);
    else
        return {};
}

}  // namespace

std::string_view path_of(const AnyKey& key) noexcept {
    return std::visit([](const auto* declared) { return declared->path; }, key);
}

std::string_view unit_of(const AnyKey& key) noexcept {
    const auto unit = []<class Key>(const Key* declared) -> std::string_view {
        if constexpr (requires { declared->unit; })
            return declared->unit;
        else
            return {};
    };
    return std::visit(unit, key);
}

std::string_view meaning_of(const AnyKey& key) noexcept {
    return std::visit([](const auto* declared) { return declared->meaning; }, key);
}

bool is_in_node_block(const AnyKey& key) noexcept {
    return std::visit([](const auto* declared) { return declared->is_in_node_block; }, key);
}

std::vector<std::string_view> names_of(const KeyTable& table) {
    std::vector<std::string_view> names;
    names.reserve(table.keys.size());
    for (const AnyKey& key : table.keys) names.push_back(name_of(path_of(key)));
    return names;
}

std::string expected_text(const AnyKey& key) {
    const std::string each = std::visit([](const auto* declared) { return accepted(*declared); }, key);
    if (path_of(key).ends_with("[]")) return "a list, each " + each;
    return path_of(key).ends_with("{}") ? "a table, each " + each : each;
}

std::string default_text(const AnyKey& key) {
    return std::visit([](const auto* declared) { return fallback_text(*declared); }, key);
}

}  // namespace octoskin::rig
