#include "host/io/candump/log_line.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <optional>

#include "common/wire/interface_name.hpp"

namespace octoskin::candump {
namespace {

// From linux/can.h: the flag of an error frame, and the masks for both lengths of identifiers.
constexpr std::uint32_t kErrorFlag = 0x2000'0000U;
constexpr std::uint32_t kExtendedIdMax = 0x1FFF'FFFFU;
constexpr std::uint32_t kStandardIdMax = 0x7FFU;
constexpr unsigned kBitRateSwitchFlag = 1U;

// The year 2262, where nanoseconds since 1970 reach 63 bits, in seconds: 10 digits.
constexpr std::int64_t kSecondsMax = 9'223'372'035;

constexpr std::string_view kBlanks = " \t";

/// Removes blanks and the word after them, and returns the word; empty if there is none.
std::string_view take_word(std::string_view& rest) {
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    const std::string_view word = rest.substr(0, rest.find_first_of(kBlanks));
    rest.remove_prefix(word.size());
    return word;
}

/// `candump -c` colours its output: ESC, '[', digits, 'm'.
std::string without_colours(std::string_view line) {
    std::string plain;
    while (!line.empty()) {  // each iteration removes the text up to an ESC, and the ESC
        const std::size_t escape = std::min(line.find('\x1B'), line.size());
        plain += line.substr(0, escape);
        line.remove_prefix(escape);
        line.remove_prefix(line.empty() ? 0 : std::min(line.find('m'), line.size() - 1) + 1);
    }
    return plain;
}

template <class Integer>
std::optional<Integer> parse_number(std::string_view digits, int base) {
    Integer value{};
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value, base);
    if (digits.empty() || error != std::errc{} || stop != end || digits.front() == '-') {
        return std::nullopt;
    }
    return value;
}

/// For "2025-06-15 15:06:40", which is local time of an unknown zone: only differences matter.
std::optional<std::int64_t> parse_date(std::string_view text) {
    namespace ch = std::chrono;
    if (text.size() != 19 || text[4] != '-' || text[7] != '-' || text[10] != ' ' || text[13] != ':' ||
        text[16] != ':')
        return std::nullopt;
    const auto field = [&](std::size_t begin, std::size_t length) {
        return parse_number<unsigned>(text.substr(begin, length), 10);
    };
    const auto year = field(0, 4), month = field(5, 2), day = field(8, 2);
    const auto hour = field(11, 2), minute = field(14, 2), second = field(17, 2);
    if (!year || !month || !day || !hour || !minute || !second) return std::nullopt;
    const ch::year_month_day date{ch::year(static_cast<int>(*year)), ch::month(*month), ch::day(*day)};
    if (!date.ok() || *year < 1970 || *hour > 23 || *minute > 59 || *second > 60) return std::nullopt;
    return ch::sys_days(date).time_since_epoch().count() * std::int64_t{86'400} + *hour * 3'600 +
           *minute * 60 + *second;
}

/// Removes "(1436509053.850870)" or "(2025-06-15 15:06:40.000220)" and returns it in whole microseconds.
std::optional<WallTime> take_stamp(std::string_view& rest) {
    constexpr std::size_t kDecimalsMin = 3;
    constexpr std::size_t kDecimalsMax = 9;
    const std::size_t end = rest.find(')');
    const std::size_t point = rest.find('.');
    if (end == std::string_view::npos || point == std::string_view::npos || point > end) return std::nullopt;
    const std::string_view whole = rest.substr(1, point - 1);
    const std::string_view decimals = rest.substr(point + 1, end - point - 1);
    rest.remove_prefix(end + 1);
    const bool is_apart = rest.empty() || kBlanks.find(rest.front()) != std::string_view::npos;
    if (!is_apart || decimals.size() < kDecimalsMin || decimals.size() > kDecimalsMax) return std::nullopt;
    const auto date = parse_date(whole);
    const auto seconds = date ? date : parse_number<std::int64_t>(whole, 10);
    auto fraction = parse_number<std::int64_t>(decimals, 10);
    if (!seconds || !fraction || *seconds > kSecondsMax) return std::nullopt;
    for (std::size_t i = decimals.size(); i < kDecimalsMax; ++i) *fraction *= 10;
    return WallTime{(*seconds * 1'000'000 + *fraction / 1000) * 1000};
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

/// `candump -8` appends the raw length code of a classical frame of 8 bytes: "_9" to "_F".
std::string_view without_length_code(std::string_view body) {
    constexpr std::size_t kCode = 2;
    const bool has_code = body.size() > kCode && body[body.size() - kCode] == '_' &&
                          std::string_view("9ABCDEF").find(body.back()) != std::string_view::npos;
    const std::string_view before = body.substr(0, body.size() - (has_code ? kCode : 0));
    const bool is_of_eight_bytes = before.size() == 2 * wire::kClassicalPayloadMax || before == "R8";
    return is_of_eight_bytes ? before : body;
}

/// `body`: the text after the identifier, with its '#'.
std::optional<LineFault> parse_body(std::string_view body, wire::CanFrame& frame) {
    body.remove_prefix(1);
    if (!body.starts_with('#')) body = without_length_code(body);
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

/// `word`: "044#2A", identifier and body without a blank.
std::optional<LineFault> parse_compact(std::string_view word, std::size_t hash, std::string_view rest,
                                       wire::CanFrame& frame) {
    if (hash == 0 || !parse_identifier(word.substr(0, hash), frame)) return LineFault::identifier;
    const std::string_view mark = take_word(rest);
    const bool is_marked = mark.empty() || mark == "R" || mark == "T";
    if (!is_marked || !take_word(rest).empty()) return LineFault::data;
    return parse_body(word.substr(hash), frame);
}

/// The length in candump's screen format: "[8]" for a classical frame, "{F}" for its raw code, "[08]" for CAN
/// FD.
std::optional<std::size_t> parse_shown_length(std::string_view word, bool& is_fd) {
    constexpr std::size_t kClassical = 3;
    if (word.size() < kClassical) return std::nullopt;
    const std::string_view digits = word.substr(1, word.size() - 2);
    if (word.front() == '{' && word.back() == '}' && word.size() == kClassical) {
        const auto code = parse_number<std::size_t>(digits, 16);
        return code ? std::optional(std::min<std::size_t>(*code, wire::kClassicalPayloadMax)) : std::nullopt;
    }
    is_fd = word.size() > kClassical;
    return word.front() == '[' && word.back() == ']' ? parse_number<std::size_t>(digits, 10) : std::nullopt;
}

/// candump's screen format: " 044 [5] 2A 36 6C 2B BA", possibly followed by the text of -a or of an error.
std::optional<LineFault> parse_shown(std::string_view identifier, std::string_view rest,
                                     wire::CanFrame& frame) {
    if (!parse_identifier(identifier, frame)) return LineFault::identifier;
    const auto length = parse_shown_length(take_word(rest), frame.is_fd);
    if (!length) return LineFault::data;
    if (frame.is_fd ? !wire::is_fd_length(*length) : *length > wire::kClassicalPayloadMax)
        return LineFault::length;
    frame.payload_len = static_cast<std::uint8_t>(*length);
    if (std::string_view words = rest; !frame.is_fd && take_word(words) == "remote") {
        frame.is_remote = true;
        return take_word(words) == "request" && take_word(words).empty() ? std::nullopt
                                                                         : std::optional(LineFault::data);
    }
    for (std::size_t i = 0; i < *length; ++i) {
        const std::string_view word = take_word(rest);
        const auto byte = word.size() == 2 ? parse_number<std::uint8_t>(word, 16) : std::nullopt;
        if (!byte) return LineFault::data;
        frame.data[i] = *byte;
    }
    const std::string_view behind = take_word(rest);
    const bool is_known = behind.empty() || behind.starts_with('\'') || behind == "ERRORFRAME";
    return is_known ? std::nullopt : std::optional(LineFault::data);
}

/// From `candump -x`: "RX" or "TX", then a letter or '-' each for bit rate switch and error state. True if
/// the frame had a bit rate switch.
bool take_shown_flags(std::string_view& word, std::string_view& rest) {
    if (word != "RX" && word != "TX") return false;
    const bool has_switch = take_word(rest) == "B";
    static_cast<void>(take_word(rest));
    word = take_word(rest);
    return has_switch;
}

}  // namespace

Result<LogEntry, LineFault> parse_line(std::string_view line) {
    if (line.find('\x1B') != std::string_view::npos) return parse_line(without_colours(line));
    if (line.ends_with('\r')) line.remove_suffix(1);
    line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
    if (line.empty()) return unexpected(LineFault::blank);
    if (line.front() != '(') return unexpected(LineFault::foreign);
    const auto stamp = take_stamp(line);
    if (!stamp) return unexpected(LineFault::timestamp);
    LogEntry entry{.stamp = *stamp, .interface = {}, .frame = {}};
    const std::string_view interface = take_word(line);
    if (!wire::is_interface_name(interface)) return unexpected(LineFault::interface);
    entry.interface = interface;
    std::string_view word = take_word(line);
    const bool has_switch = take_shown_flags(word, line);
    const std::size_t hash = word.find('#');
    const auto fault = hash == std::string_view::npos ? parse_shown(word, line, entry.frame)
                                                      : parse_compact(word, hash, line, entry.frame);
    if (fault) return unexpected(*fault);
    entry.frame.has_bit_rate_switch |= has_switch && entry.frame.is_fd;
    return entry;
}

std::string format_line(const LogEntry& entry) {
    const wire::CanFrame& frame = entry.frame;
    assert(entry.stamp.ns >= 0);
    assert(wire::is_interface_name(entry.interface));
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
