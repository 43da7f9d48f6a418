// Values of a daemon's answer, which another version or another program may have written.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace octoskin {

/// The value of a key; null if there is none, or if `object` is no object.
[[nodiscard]] inline const nlohmann::ordered_json& at(const nlohmann::ordered_json& object,
                                                      const std::string& key) {
    static const nlohmann::ordered_json kNothing;
    if (!object.is_object()) return kNothing;
    const auto found = object.find(key);
    return found != object.end() ? *found : kNothing;
}

}  // namespace octoskin
