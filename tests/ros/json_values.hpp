// Single values, sequences and arrays of a message as JSON. make_codecs.py writes the same two functions,
// json_of and read_json, for each message; both sets find each other through their argument of this
// namespace.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "tests/ros/codec.hpp"

namespace octoskin::ros {

/// Where a value is in the JSON, for messages: "header/stamp".
struct Place {
    std::string path;

    [[nodiscard]] Place at(const std::string& name) const {
        return {path.empty() ? name : path + "/" + name};
    }
    [[noreturn]] void refuse(const std::string& reason) const {
        throw std::invalid_argument((path.empty() ? "message" : path) + ": " + reason);
    }
};

template <typename Value>
constexpr bool is_byte = sizeof(Value) == 1 && std::is_integral_v<Value> && !std::is_same_v<Value, bool>;

/// The bytes as {"size": 3, "hex": "01ff00"}, or with "head", the first 32, instead of "hex".
[[nodiscard]] Json json_of_bytes(const std::uint8_t* bytes, std::size_t size, const Shown& shown);

/// Takes {"hex": "01ff00"}, {"size": 3, "value": 7}, {"file": "picture.png"} or a list of numbers.
[[nodiscard]] Bytes read_bytes(const Json& json, const Place& place);

/// Refuses members of `json` that are not in `names`.
void refuse_other_members(const Json& json, const std::vector<std::string>& names, const Place& place);

[[nodiscard]] Json json_of(const std::string& value, const Shown& shown);
void read_json(const Json& json, std::string& value, const Place& place);

/// A real number that JSON lacks is "nan", "inf" or "-inf".
[[nodiscard]] Json json_of_real(double value);
[[nodiscard]] double read_real(const Json& json, const Place& place);

template <typename Number>
requires std::is_arithmetic_v<Number> Json json_of(Number value, const Shown&) {
    if constexpr (std::is_floating_point_v<Number>) {
        return json_of_real(static_cast<double>(value));
    } else {
        return value;
    }
}

template <typename Number>
requires std::is_arithmetic_v<Number>
void read_json(const Json& json, Number& value, const Place& place) {
    if constexpr (std::is_same_v<Number, bool>) {
        if (!json.is_boolean()) {
            place.refuse("neither true nor false");
        }
        value = json.get<bool>();
    } else if constexpr (std::is_floating_point_v<Number>) {
        value = static_cast<Number>(read_real(json, place));
    } else {
        if (!json.is_number_integer()) {
            place.refuse("not a whole number");
        }
        const auto number = json.get<std::int64_t>();
        if (number < std::int64_t{std::numeric_limits<Number>::min()} ||
            number > std::int64_t{std::numeric_limits<Number>::max()}) {
            place.refuse("out of range: " + std::to_string(number));
        }
        value = static_cast<Number>(number);
    }
}

template <typename Value>
Json json_of(const std::vector<Value>& values, const Shown& shown) {
    if constexpr (is_byte<Value>) {
        return json_of_bytes(reinterpret_cast<const std::uint8_t*>(values.data()), values.size(), shown);
    } else {
        Json json = Json::array();
        for (const Value& value : values) {
            json.push_back(json_of(value, shown));
        }
        return json;
    }
}

template <typename Value>
void read_json(const Json& json, std::vector<Value>& values, const Place& place) {
    if constexpr (is_byte<Value>) {
        const Bytes bytes = read_bytes(json, place);
        values.assign(bytes.begin(), bytes.end());
    } else {
        if (!json.is_array()) {
            place.refuse("not a list");
        }
        values.clear();
        for (const Json& element : json) {
            Value value{};
            read_json(element, value, place.at(std::to_string(values.size())));
            values.push_back(value);
        }
    }
}

template <typename Value, std::size_t Size>
Json json_of(const std::array<Value, Size>& values, const Shown& shown) {
    return json_of(std::vector<Value>(values.begin(), values.end()), shown);
}

template <typename Value, std::size_t Size>
void read_json(const Json& json, std::array<Value, Size>& values, const Place& place) {
    std::vector<Value> list;
    read_json(json, list, place);
    if (list.size() != Size) {
        place.refuse("needs " + std::to_string(Size) + " elements, has " + std::to_string(list.size()));
    }
    std::copy(list.begin(), list.end(), values.begin());
}

template <typename Value>
void read_member(const Json& json, const char* name, Value& value, const Place& place) {
    if (json.contains(name)) {
        read_json(json[name], value, place.at(name));
    }
}

}  // namespace octoskin::ros
