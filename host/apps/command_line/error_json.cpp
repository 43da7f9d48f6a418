#include "host/apps/command_line/error_json.hpp"

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

/// Empty if there is none.
std::string text_at(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// 0 if there is none, or one that is no line or column.
int number_at(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number_integer()) return 0;
    const auto number = found->get<std::int64_t>();
    return number > 0 && number <= std::numeric_limits<int>::max() ? static_cast<int>(number) : 0;
}

ErrorCode code_named(std::string_view name) {
    for (const ErrorMeaning& meaning : kErrorMeanings)
        if (meaning.name == name) return meaning.code;
    return ErrorCode::bad_value;
}

/// The part of the message that has no key of its own; empty if it does not fit the other parts.
std::string what_in(const std::string& message, const Error& others) {
    Error parts = others;
    parts.what = "?";
    const std::size_t before = parts.message().size() - parts.reason().size();
    const std::size_t after = parts.reason().size() - parts.what.size();
    if (message.size() < before + after) return {};
    return message.substr(before, message.size() - before - after);
}

}  // namespace

Json to_json(const Error& error) {
    Json json{{"code", name_of(error.code)}};
    const auto add = [&json](const char* key, const std::string& text) {
        if (!text.empty()) json[key] = text;
    };
    add("file", error.file.string());
    if (error.line > 0) json["line"] = error.line;
    if (error.column > 0) json["column"] = error.column;
    add("key", error.key);
    add("value", error.value);
    add("remedy", error.remedy);
    add("others", error.others);
    json["message"] = error.message();
    return json;
}

Error error_of(const Json& json) {
    if (json.is_string()) return {.what = json.get<std::string>()};
    const Error foreign{.what = json.dump(-1, ' ', false, Json::error_handler_t::replace)};
    if (!json.is_object()) return foreign;
    Error error{.code = code_named(text_at(json, "code")),
                .value = text_at(json, "value"),
                .remedy = text_at(json, "remedy"),
                .file = text_at(json, "file"),
                .line = number_at(json, "line"),
                .column = number_at(json, "column"),
                .key = text_at(json, "key"),
                .others = text_at(json, "others")};
    const std::string message = text_at(json, "message");
    if (message.empty()) return error.message().empty() ? foreign : error;
    error.what = what_in(message, error);
    return error.message() == message ? error : Error{error.code, message};
}

}  // namespace octoskin
