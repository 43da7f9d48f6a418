#include "host/io/candump/log_line.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cstdio>
#include <optional>

namespace octoskin::candump {
namespace {

// linux/can.h: the interface's name, the flag of an error frame, and the masks of both identifier lengths.
constexpr std::size_t kInterfaceCharsMax = 15;
constexpr std::uint32_t kErrorFlag = 0x2000'0000U;
constexpr std::uint32_t kExtendedIdMax = 0x1FFF'FFFFU;
constexpr std::uint32_t kStandardIdMax = 0x7FFU;
constexpr unsigned kBitRateSwitchFlag = 1U;

// The year 2262, where nanoseconds since 1970 leave 63 bits, has a second of 10 digits.
constexpr std::int64_t kSecondsMax = 9'223'372'035;

bool is_interface_name(std::string_view name) {
    const auto is_printable = [](char c) { return c > ' ' && c <= '~'; };
    return !name.empty() && name.size() <= kInterfaceCharsMax && std::ranges::all_of(name, is_printable);
}

std::string_view take_word(std::string_view& rest) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return word;
}

template <class Integer>
std::optional<Integer> parse_number(std::string_view digits, int base) {
    Integer value{};
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value, base);
    if (error != std::errc{} || stop != end || digits.front() == '-') {
        return std::nullopt;
    }
    return value;
}

std::optional<WallTime> parse_stamp(std::string_view word) {
    const std::size_t point = word.find('.');
    if (word.size() < 2 || word.front() != '(' || word.back() != ')' || point == std::string_view::npos) {
        return std::nullopt;
    }
    const auto seconds = parse_number<std::int64_t>(word.substr(1, point - 1), 10);
    const std::string_view digits = word.substr(point + 1, word.size() - point - 2);
    const auto fraction = parse_number<std::int64_t>(digits, 10);
    if (!seconds || !fraction || *seconds > kSecondsMax || (digits.size() != 6 && digits.size() != 9)) {
        return std::nullopt;
    }
    const std::int64_t fraction_us = digits.size() == 6 ? *fraction : *fraction / 1000;
    return WallTime{(*seconds * 1'000'000 + fraction_us) * 1000};
}

bool parse_identifier(std::string_view digits, wire::CanFrame& frame) {
    const auto id = parse_number<std::uint32_t>(digits, 16);
    if (!id) {
        return false;
    }
    if (digits.size() == 3) {
        frame.can_id = *id;
        return *id <= kStandardIdMax;
    }
    frame.is_error = (*id & kErrorFlag) != 0;
    frame.is_extended = !frame.is_error;
    frame.can_id = *id & kExtendedIdMax;
    return digits.size() == 8 && (*id & ~(kErrorFlag | kExtendedIdMax)) == 0;
}

std::optional<LineFault> parse_bytes(std::string_view digits, wire::CanFrame& frame) {
    const std::size_t length = digits.size() / 2;
    for (std::size_t i = 0; i < std::min(length, frame.data.size()); ++i) {
        const auto byte = parse_number<std::uint8_t>(digits.substr(2 * i, 2), 16);
        if (!byte) {
            return LineFault::data;
        }
        frame.data[i] = *byte;
    }
    if (digits.size() % 2 != 0) {
        return LineFault::data;
    }
    if (frame.is_fd ? !wire::is_fd_length(length) : length > wire::kClassicalPayloadMax) {
        return LineFault::length;
    }
    frame.payload_len = static_cast<std::uint8_t>(length);
    return std::nullopt;
}

std::optional<LineFault> parse_remote(std::string_view length, wire::CanFrame& frame) {
    frame.is_remote = true;
    if (length.empty()) {
        return std::nullopt;
    }
    const auto value = parse_number<std::uint8_t>(length, 16);
    if (!value || length.size() != 1) {
        return LineFault::data;
    }
    if (*value > wire::kClassicalPayloadMax) {
        return LineFault::length;
    }
    frame.payload_len = *value;
    return std::nullopt;
}

/// `body`: what follows the identifier, from its '#' on.
std::optional<LineFault> parse_body(std::string_view body, wire::CanFrame& frame) {
    body.remove_prefix(1);
    if (body.starts_with('R')) {
        return parse_remote(body.substr(1), frame);
    }
    if (!body.starts_with('#')) {
        return parse_bytes(body, frame);
    }
    const auto flags = body.size() < 2 ? std::nullopt : parse_number<std::uint8_t>(body.substr(1, 1), 16);
    if (!flags) {
        return LineFault::data;
    }
    frame.is_fd = true;
    frame.has_bit_rate_switch = (*flags & kBitRateSwitchFlag) != 0;
    return parse_bytes(body.substr(2), frame);
}

}  // namespace

Result<LogEntry, LineFault> parse_line(std::string_view line) {
    if (line.ends_with('\r')) {
        line.remove_suffix(1);
    }
    if (line.find_first_not_of(" \t") == std::string_view::npos) {
        return unexpected(LineFault::blank);
    }
    if (line.front() != '(') {
        return unexpected(LineFault::foreign);
    }
    const auto stamp = parse_stamp(take_word(line));
    if (!stamp) {
        return unexpected(LineFault::timestamp);
    }
    LogEntry entry{.stamp = *stamp, .interface = {}, .frame = {}};
    const std::string_view interface = take_word(line);
    if (!is_interface_name(interface)) {
        return unexpected(LineFault::interface);
    }
    entry.interface = interface;

    const std::string_view frame = take_word(line);
    const std::size_t hash = std::min(frame.find('#'), frame.size());
    if (hash == 0 || !parse_identifier(frame.substr(0, hash), entry.frame)) {
        return unexpected(LineFault::identifier);
    }
    if (hash == frame.size() || !(line.empty() || line == "R" || line == "T")) {
        return unexpected(LineFault::data);
    }
    if (const auto fault = parse_body(frame.substr(hash), entry.frame)) {
        return unexpected(*fault);
    }
    return entry;
}

std::string format_line(const LogEntry& entry) {
    const wire::CanFrame& frame = entry.frame;
    assert(entry.stamp.ns >= 0);
    assert(is_interface_name(entry.interface));
    assert(frame.can_id <= (frame.is_extended || frame.is_error ? kExtendedIdMax : kStandardIdMax));
    assert(!(frame.is_fd && frame.is_remote));
    assert(frame.is_fd ? wire::is_fd_length(frame.payload_len)
                       : frame.payload_len <= wire::kClassicalPayloadMax);

    std::array<char, kLineBytesMax> text{};
    const std::int64_t stamp_us = entry.stamp.ns / 1000;
    int used = std::snprintf(text.data(), text.size(), "(%010lld.%06lld) %s ",
                             static_cast<long long>(stamp_us / 1'000'000),
                             static_cast<long long>(stamp_us % 1'000'000), entry.interface.c_str());
    const auto append = [&](const char* format, unsigned value) {
        used +=
            std::snprintf(text.data() + used, text.size() - static_cast<std::size_t>(used), format, value);
    };
    if (frame.is_error) {
        append("%08X#", frame.can_id | kErrorFlag);
    } else {
        append(frame.is_extended ? "%08X#" : "%03X#", frame.can_id);
    }
    if (frame.is_remote) {
        append(frame.payload_len > 0 ? "R%u" : "R", frame.payload_len);
    } else {
        if (frame.is_fd) {
            append("#%X", frame.has_bit_rate_switch ? kBitRateSwitchFlag : 0U);
        }
        for (const std::uint8_t byte : frame.payload()) {
            append("%02X", byte);
        }
    }
    append("\n", 0);
    return {text.data(), static_cast<std::size_t>(used)};
}

}  // namespace octoskin::candump
