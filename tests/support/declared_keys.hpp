// Changes the value of a declared key in a document, and the refusal that its declaration promises.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/key.hpp"

namespace octoskin::testing_support {

/// The value at the path of a declaration: of a list its first item, of a table of any keys its first. What
/// is missing on the way is added, empty.
[[nodiscard]] inline rig::Value& value_at(rig::Value& top, std::string_view path) {
    rig::Value* value = &top;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find('.', begin), path.size());
        const std::string_view part = path.substr(begin, end - begin);
        const std::string_view name = rig::name_of(part);
        value->kind = rig::Value::Kind::table;
        const auto found = std::ranges::find(value->items, name, &rig::Value::key);
        if (found != value->items.end()) {
            value = &*found;
        } else {
            value->items.emplace_back().key = name;
            value = &value->items.back();
        }
        if (part != name) {
            value->kind = part.ends_with("[]") ? rig::Value::Kind::list : rig::Value::Kind::table;
            if (value->items.empty()) value->items.emplace_back();
            value = &value->items.front();
        }
        begin = end + 1;
    }
    return *value;
}

[[nodiscard]] inline rig::Value scalar(std::string key, std::string text) {
    rig::Value value;
    value.kind = rig::Value::Kind::scalar;
    value.key = std::move(key);
    value.text = std::move(text);
    return value;
}

/// "expected a whole number from 0 to 3", also for the items of a list.
[[nodiscard]] inline std::string refusal_of(const rig::AnyKey& key) {
    constexpr std::string_view kEach = "each ";
    const std::string text = rig::expected_text(key);
    const auto each = text.find(kEach);
    return "expected " + (each == std::string::npos ? text : text.substr(each + kEach.size()));
}

}  // namespace octoskin::testing_support
