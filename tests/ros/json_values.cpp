#include "tests/ros/json_values.hpp"

#include <algorithm>

namespace octoskin::ros {
namespace {

constexpr std::size_t kHeadSize = 32;
constexpr const char* kDigits = "0123456789abcdef";

std::string hex(const std::uint8_t* bytes, std::size_t size) {
    std::string text;
    for (std::size_t i = 0; i < size; ++i) {
        text += {kDigits[bytes[i] >> 4], kDigits[bytes[i] & 15]};
    }
    return text;
}

std::uint8_t digit(char character, const Place& place) {
    const std::string_view digits = kDigits;
    const auto found = digits.find(character);
    if (found == std::string_view::npos) {
        place.refuse("not a hexadecimal digit: '" + std::string(1, character) + "'");
    }
    return static_cast<std::uint8_t>(found);
}

Bytes from_hex(const std::string& text, const Place& place) {
    if (text.size() % 2 != 0) {
        place.refuse("half a byte at the end");
    }
    Bytes bytes;
    for (std::size_t i = 0; i < text.size(); i += 2) {
        bytes.push_back(static_cast<std::uint8_t>(16 * digit(text[i], place) + digit(text[i + 1], place)));
    }
    return bytes;
}

/// A byte as 0 to 255, or as -128 to 127.
std::uint8_t byte(const Json& json, const Place& place) {
    int number = 0;
    read_json(json, number, place);
    if (number < -128 || number > 255) {
        place.refuse("not a byte: " + std::to_string(number));
    }
    return static_cast<std::uint8_t>(number);
}

}  // namespace

Json json_of_bytes(const std::uint8_t* bytes, std::size_t size, const Shown& shown) {
    if (shown.has_all_bytes) {
        return {{"size", size}, {"hex", hex(bytes, size)}};
    }
    return {{"size", size}, {"head", hex(bytes, std::min(size, kHeadSize))}};
}

Bytes read_bytes(const Json& json, const Place& place) {
    if (json.is_object() && json.contains("hex")) {
        return from_hex(json["hex"].get<std::string>(), place);
    }
    if (json.is_object() && json.contains("file")) {
        return read_file(json["file"].get<std::string>());
    }
    if (json.is_object() && json.contains("size")) {
        const std::uint8_t value = json.contains("value") ? byte(json["value"], place) : std::uint8_t{0};
        return Bytes(json["size"].get<std::size_t>(), value);
    }
    if (!json.is_array()) {
        place.refuse("neither a list of bytes nor an object with 'hex', 'size' or 'file'");
    }
    Bytes bytes;
    for (const Json& element : json) {
        bytes.push_back(byte(element, place));
    }
    return bytes;
}

void refuse_other_members(const Json& json, const std::vector<std::string>& names, const Place& place) {
    if (!json.is_object()) {
        place.refuse("not an object");
    }
    for (const auto& [name, value] : json.items()) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            place.at(name).refuse("the message has no such field");
        }
    }
}

Json json_of(const std::string& value, const Shown&) {
    return value;
}

void read_json(const Json& json, std::string& value, const Place& place) {
    if (!json.is_string()) {
        place.refuse("not a text");
    }
    value = json.get<std::string>();
}

Json json_of_real(double value) {
    if (std::isfinite(value)) {
        return value;
    }
    return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

double read_real(const Json& json, const Place& place) {
    if (json == "nan") {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (json == "inf" || json == "-inf") {
        return json == "inf" ? std::numeric_limits<double>::infinity()
                             : -std::numeric_limits<double>::infinity();
    }
    if (!json.is_number()) {
        place.refuse("not a number");
    }
    return json.get<double>();
}

}  // namespace octoskin::ros
