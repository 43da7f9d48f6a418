// JSON as text for clients.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace octoskin::view {

/// On one line. Bytes that are no UTF-8, which names of a robot may have, become U+FFFD. Throws
/// std::bad_alloc.
[[nodiscard]] inline std::string text_of(const nlohmann::ordered_json& json) {
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace octoskin::view
