// Which topics of an export go into the file.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace octoskin::bridge {

/// Whether `topic` is `name`, or below it: "/octoskin/range/n1_s0" is below "/octoskin/range".
[[nodiscard]] inline bool is_within(std::string_view topic, std::string_view name) noexcept {
    return topic.starts_with(name) && (topic.size() == name.size() || topic[name.size()] == '/');
}

struct TopicChoice {
    bool takes_all = false;
    std::vector<std::string> only = {};      ///< empty: the default
    std::vector<std::string> also = {};      ///< beside the default
    std::vector<std::string> left_out = {};  ///< of the default

    [[nodiscard]] bool takes(std::string_view topic) const {
        const auto has = [topic](const std::vector<std::string>& names) {
            return std::ranges::any_of(names, [topic](const auto& name) { return is_within(topic, name); });
        };
        if (takes_all) return true;
        return only.empty() ? has(also) || !has(left_out) : has(only) || has(also);
    }
};

}  // namespace octoskin::bridge
