// One line of a candump log, in the compact form of `candump -L` and `candump -l`, or in candump's screen
// format:
//
//     (1436509053.850870) vcan0 044#2A366C2BBA           classical; with 8 digits: an extended identifier,
//                                                        or an error frame
//     (1436509053.850870) vcan0 044#R4                   remote, with its length if that is not 0
//     (1436509053.850870) vcan0 044#2A366C2BBA010203_F   with -8: the raw length code of 8 bytes
//     (1436509053.850870) vcan0 044##12A366C2B           CAN FD: a digit of flags (1: bit rate switch), data
//      (1436509053.850870)  vcan0  044   [5]  2A 36 6C 2B BA
//      (1436509053.850870)  vcan0  RX B -  044  [05]  2A 36 6C 2B BA     -x: direction and flags; CAN FD
//
// The time is in seconds with 3 to 9 decimals or, with `-t A`, a date and a time of day. Words are separated
// by any number of blanks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"

namespace octoskin::candump {

struct LogEntry {
    WallTime stamp;         ///< whole microseconds, not negative
    std::string interface;  ///< valid by wire::is_interface_name
    wire::CanFrame frame;
    friend bool operator==(const LogEntry&, const LogEntry&) = default;
};

/// Why a line is not an entry; each has a counter.
enum class LineFault : std::uint8_t {
    blank,       ///< empty, or only blanks
    foreign,     ///< does not begin with '(': not written by candump
    timestamp,   ///< neither "(seconds.fraction)" nor "(date time.fraction)", 3 to 9 digits of fraction
    interface,   ///< missing, or not valid by wire::is_interface_name
    identifier,  ///< not 3 or 8 hexadecimal digits, or out of range
    data,    ///< neither '#' nor "[length]", a character that is not hexadecimal, half a byte, or text after
             ///< the frame
    length,  ///< more than 8 bytes, or a length that CAN FD does not have
    too_long,   ///< more than kLineBytesMax bytes
    truncated,  ///< the file ends within the line
};
[[nodiscard]] constexpr std::array<const char*, 9> names_of(LineFault) {
    return {"line_blank", "line_foreign", "line_timestamp", "line_interface", "line_identifier",
            "line_data",  "line_length",  "line_too_long",  "line_truncated"};
}

/// The longest line of candump has 282 bytes: colour 10, time stamp 31, interface 17, direction 8, identifier
/// 12, length 6, data 192, colour 4, CR and LF.
inline constexpr std::size_t kLineBytesMax = 320;

/// Parses `line`, which has no line feed. A carriage return at its end and colours are removed; a direction
/// mark ("R", "T") after the frame is allowed. Dates are treated as UTC. Never returns `too_long` or
/// `truncated`. Safe for any bytes.
[[nodiscard]] Result<LogEntry, LineFault> parse_line(std::string_view line);

/// The line of an entry, with a line feed. The time stamp is cut to whole microseconds. Asserts the
/// conditions of `LogEntry`, and a length that the frame's format has.
[[nodiscard]] std::string format_line(const LogEntry& entry);

}  // namespace octoskin::candump
