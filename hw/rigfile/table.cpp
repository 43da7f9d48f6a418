#include "hw/rigfile/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/key_hint.hpp"

namespace octoskin::rig {
namespace {

constexpr std::size_t kNameLengthMax = 64;
constexpr std::size_t kElementNameMax = 256;

template <class T>
std::optional<T> parse_all(std::string_view text, auto... format) {
    T parsed{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed, format...);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return parsed;
}

template <class T>
std::optional<T> parse_integer(std::string_view text) {
    if (text.starts_with("0x") || text.starts_with("0X")) {
        // No sign after the prefix: from_chars would read "0x-1".
        if (text.size() > 2 && text[2] == '-') return std::nullopt;
        return parse_all<T>(text.substr(2), 16);
    }
    return parse_all<T>(text, 10);
}

bool is_name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == '/';
}

/// The error for a value that is not a plain number or flag, or is outside its range.
template <class Parse>
Error misread(const Value& value, std::string expected, Parse parse) {
    const bool is_scalar = value.kind == Value::Kind::scalar;
    const bool is_parsed = is_scalar && parse(value.text);
    Error error{.code = is_parsed && !value.is_quoted ? ErrorCode::out_of_range : ErrorCode::wrong_type,
                .what = std::move(expected),
                .value = describe(value)};
    if (!is_scalar) return error;
    if (value.is_quoted && is_parsed) {
        error.remedy = "leave out the quotes, which make it a text";
        return error;
    }
    std::string pointed = value.text;
    const auto comma = pointed.find(',');
    if (comma == std::string::npos) return error;
    pointed[comma] = '.';
    if (parse_all<double>(pointed)) error.remedy = fmt::format("write a decimal point: {}", pointed);
    return error;
}

bool is_number_of_digits(std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Hint with the tables that have the key; empty if there is none.
std::string hint_below(std::string_view key, std::span<const std::string> keys_below) {
    const std::string ending = fmt::format(".{}", key);
    std::string found;
    for (const std::string& path : keys_below) {
        if (!path.ends_with(ending)) continue;
        found += (found.empty() ? "did you mean " : " or ") + path;
    }
    return found.empty() ? found : found + "?";
}

/// The length of the first character of `text`, which is not empty; 0 if it cannot be written to a YAML file:
/// not UTF-8, a surrogate, or a noncharacter.
std::size_t character_length(std::string_view text) {
    const auto first = static_cast<unsigned char>(text[0]);
    const std::size_t length = first < 0x80U   ? 1U
                               : first < 0xC2U ? 0U
                               : first < 0xE0U ? 2U
                               : first < 0xF0U ? 3U
                                               : 4U;
    if (length == 0 || length > text.size() || first > 0xF4U) return 0;
    std::uint32_t code = length == 1 ? first : first & (0x7FU >> length);
    for (const char c : text.substr(1, length - 1)) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xC0U) != 0x80U) return 0;
        code = (code << 6U) | (byte & 0x3FU);
    }
    constexpr std::array<std::uint32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
    const bool is_set_aside = (code >= 0xD800 && code < 0xE000) || (code >= 0xFDD0 && code < 0xFDF0) ||
                              (code & 0xFFFEU) == 0xFFFEU || code > 0x10FFFF;
    return code < kLeast[length] || is_set_aside ? 0 : length;
}

bool is_writable_text(std::string_view text) {
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        if (length == 0) return false;
        text.remove_prefix(length);
    }
    return true;
}

/// Control characters: ASCII's, and in UTF-8 those from U+0080 to U+009F.
bool has_control_character(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : '\0');
        if (byte < 0x20U || byte == 0x7FU || (byte == 0xC2U && next < 0xA0U)) return true;
    }
    return false;
}

std::optional<bool> parse_flag(std::string_view text) {
    if (text != "true" && text != "false") return std::nullopt;
    return text == "true";
}

bool is_plain_scalar(const Value& value) {
    return value.kind == Value::Kind::scalar && !value.is_quoted;
}

}  // namespace

void fail(const Value& value, const std::string& path, Error error) {
    if (value.file) error.file = value.file->shown();
    error.line = value.line;
    error.key = path;
    throw error;
}

std::string describe(const Value& value) {
    switch (value.kind) {
        case Value::Kind::null:
            return "nothing";
        case Value::Kind::scalar:
            return fmt::format("'{}'", value.text.substr(0, kNameLengthMax));
        case Value::Kind::list:
            return fmt::format("a list of {}", value.items.size());
        case Value::Kind::table:
            return "a table";
    }
    return "nothing";
}

double read_number(const Value& value, const std::string& path, Range<double> range) {
    const auto number = is_plain_scalar(value) ? parse_all<double>(value.text) : std::nullopt;
    // NaN, which from_chars reads, must be outside every range.
    if (!number || !(*number >= range.min && *number <= range.max)) {
        fail(value, path,
             misread(value, fmt::format("expected a number from {} to {}", range.min, range.max),
                     [](std::string_view text) { return parse_all<double>(text); }));
    }
    return *number;
}

std::int64_t read_integer(const Value& value, const std::string& path, Range<std::int64_t> range) {
    const auto number = is_plain_scalar(value) ? parse_integer<std::int64_t>(value.text) : std::nullopt;
    if (!number || *number < range.min || *number > range.max) {
        fail(value, path,
             misread(value, fmt::format("expected a whole number from {} to {}", range.min, range.max),
                     parse_integer<std::int64_t>));
    }
    return *number;
}

std::uint64_t read_unsigned(const Value& value, const std::string& path) {
    const auto number = is_plain_scalar(value) ? parse_integer<std::uint64_t>(value.text) : std::nullopt;
    if (!number) {
        fail(value, path,
             misread(value, "expected a whole number from 0 to 2^64 - 1", parse_integer<std::uint64_t>));
    }
    return *number;
}

std::string read_text(const Value& value, const std::string& path) {
    if (value.kind != Value::Kind::scalar)
        fail(value, path, {ErrorCode::wrong_type, "expected a text", describe(value)});
    if (!is_writable_text(value.text))
        fail(value, path, {ErrorCode::bad_value, "expected a text in UTF-8", "other bytes"});
    return value.text;
}

std::string read_name(const Value& value, const std::string& path) {
    const bool is_name = value.kind == Value::Kind::scalar && !value.text.empty() &&
                         value.text.size() <= kNameLengthMax &&
                         std::all_of(value.text.begin(), value.text.end(), is_name_character);
    if (!is_name) {
        fail(value, path,
             {ErrorCode::bad_name,
              fmt::format("expected a name of 1 to {} letters, digits or _ - . /", kNameLengthMax),
              describe(value)});
    }
    return value.text;
}

std::string read_element_name(const Value& value, const std::string& path) {
    const bool is_name = value.kind == Value::Kind::scalar && !value.text.empty() &&
                         value.text.size() <= kElementNameMax && is_writable_text(value.text) &&
                         !has_control_character(value.text);
    if (!is_name) {
        fail(
            value, path,
            {ErrorCode::bad_name,
             fmt::format("expected a name of 1 to {} bytes of UTF-8 without control characters, in quotes if "
                         "it is more than letters and digits",
                         kElementNameMax),
             describe(value)});
    }
    return value.text;
}

const std::vector<Value>& read_list(const Value& value, const std::string& path) {
    if (value.kind != Value::Kind::list) {
        fail(value, path, {ErrorCode::wrong_type, "expected a list", describe(value)});
    }
    return value.items;
}

Table::Table(const Value& value, std::string path, std::span<const std::string_view> known_keys,
             std::span<const std::string> keys_below)
    : value_(value), path_(std::move(path)) {
    if (value.kind != Value::Kind::table) {
        rig::fail(value, path_, {ErrorCode::wrong_type, "expected a table of keys", describe(value)});
    }
    const auto is_known = [&known_keys](const Value& item) {
        return std::find(known_keys.begin(), known_keys.end(), item.key) != known_keys.end();
    };
    for (const Value& item : value.items) {
        if (is_known(item)) continue;
        // An untrusted `extends` may name any file of this machine: its content is not shown.
        const bool is_of_another_kind =
            std::none_of(value.items.begin(), value.items.end(),
                         [&](const Value& other) { return other.file == item.file && is_known(other); });
        if (path_.empty() && !item.is_quotable && is_of_another_kind) {
            throw Error{.code = ErrorCode::foreign_format,
                        .what = "expected a known key, found none in this file",
                        .remedy = "known here are " + joined(known_keys) + "; is it a file of another kind?",
                        .file = item.file->shown(),
                        .line = item.line};
        }
        // In a flow table a comma ends a value: {a: 0,02} has the keys a and 02.
        const bool is_fraction = item.kind == Value::Kind::null && is_number_of_digits(item.key);
        std::string hint = is_fraction ? fmt::format(
                                             "if it is part of a number such as 0,{0}, write a decimal "
                                             "point: 0.{0}",
                                             item.key)
                                       : hint_below(item.key, keys_below);
        if (hint.empty()) hint = hint_for_key(item.key, known_keys, path_);
        rig::fail(item, path_of(item.key),
                  {.code = ErrorCode::unknown_key,
                   .what = "expected a known key, found this one",
                   .remedy = std::move(hint)});
    }
}

Table::Table(const Value& value, std::string path, const KeyTable& declared)
    : Table(value, std::move(path), names_of(declared)) {}

std::string Table::path_of(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

const Value* Table::find(std::string_view key) const noexcept {
    const Value* found = value_.find(key);
    return found && found->kind != Value::Kind::null ? found : nullptr;
}

const Value& Table::require(std::string_view key) const {
    if (const Value* found = find(key)) return *found;
    rig::fail(value_, path_of(key),
              {.code = ErrorCode::missing_key,
               .what = "expected this key, found none",
               .remedy = value_.replaces_inherited ? "add it (a list replaces the inherited one as a whole)"
                                                   : "add it"});
}

double Table::number(std::string_view key, Range<double> range, std::optional<double> fallback) const {
    if (!find(key) && fallback) return *fallback;
    return read_number(require(key), path_of(key), range);
}

bool Table::flag(std::string_view key, std::optional<bool> fallback) const {
    if (!find(key) && fallback) return *fallback;
    const Value& value = require(key);
    const auto parsed = is_plain_scalar(value) ? parse_flag(value.text) : std::nullopt;
    if (!parsed) rig::fail(value, path_of(key), misread(value, "expected true or false", parse_flag));
    return *parsed;
}

std::uint64_t Table::unsigned_integer(std::string_view key, std::uint64_t fallback) const {
    const Value* found = find(key);
    return found ? read_unsigned(*found, path_of(key)) : fallback;
}

std::string Table::name(std::string_view key) const {
    return read_name(require(key), path_of(key));
}

std::string Table::element_name(std::string_view key) const {
    return read_element_name(require(key), path_of(key));
}

std::string Table::folder_name(std::string_view key) const {
    std::string name = this->name(key);
    if (name.find('/') == std::string::npos && name.find("..") == std::string::npos && name != ".")
        return name;
    fail(key, {ErrorCode::bad_name, "expected a name that a folder can have", fmt::format("'{}'", name),
               "leave out / and .., and do not use . alone; folders of recordings and flashed boards get "
               "this name"});
}

std::string Table::text(std::string_view key) const {
    const Value* found = find(key);
    return found ? read_text(*found, path_of(key)) : "";
}

std::string Table::text(const TextKey& key) const {
    switch (key.kind) {
        case TextKind::name:
            return name(name_of(key));
        case TextKind::folder_name:
            return folder_name(name_of(key));
        case TextKind::element_name:
            return element_name(name_of(key));
        case TextKind::path:
            break;
    }
    return read_text(require(key), path_of(key));
}

const std::vector<Value>& Table::list(const ListKey& key) const {
    return read_list(require(key), path_of(key));
}

void Table::fail(std::string_view key, Error error) const {
    const Value* found = find(key);
    rig::fail(found ? *found : value_, path_of(key), std::move(error));
}

void Table::fail_choice(std::string_view key, const std::string& expected) const {
    fail(key, {ErrorCode::unknown_word, "expected " + expected, describe(require(key))});
}

}  // namespace octoskin::rig
