// Errors as JSON, in answers of the daemon and on standard error.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "host/errors/error.hpp"

namespace octoskin {

/// "code" and "message", and of "file", "line", "column", "key", "value", "remedy" and "others" those that
/// are not empty.
[[nodiscard]] nlohmann::ordered_json to_json(const Error& error);

/// The error of such an object, with the same message. If the object is another program's or lacks a part,
/// the result contains what can be recognised. An unknown code becomes `bad_value`. If the message does not
/// contain the other parts, only code and message are used. A JSON text becomes the message. Throws
/// std::bad_alloc only.
[[nodiscard]] Error error_of(const nlohmann::ordered_json& json);

}  // namespace octoskin
