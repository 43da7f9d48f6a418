// One line of a candump log. The compact form is that of `candump -L` and `candump -l`, the other is what
// candump shows on a screen:
//
//     (1436509053.850870) vcan0 044#2A366C2BBA           classical; an identifier of 8 digits is extended, or
//     an
//                                                        error frame
//     (1436509053.850870) vcan0 044#R4                   remote, with its length if that is not 0
//     (1436509053.850870) vcan0 044#2A366C2BBA010203_F   with -8: the raw length code of 8 bytes
//     (1436509053.850870) vcan0 044##12A366C2B           CAN FD: a digit of flags (1 = bit rate switch), data
//      (1436509053.850870)  vcan0  044   [5]  2A 36 6C 2B BA
//      (1436509053.850870)  vcan0  RX B -  044  [05]  2A 36 6C 2B BA     -x: direction and flags; CAN FD
//
// The time is seconds with 3 to 9 decimals, or, with `-t A`, a date and a time of day. Any number of blanks
// separates words.
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
    std::string interface;  ///< as wire::is_interface_name has it
    wire::CanFrame frame;
    friend bool operator==(const LogEntry&, const LogEntry&) = default;
};

/// Why a line is no entry. One counter each.
enum class LineFault : std::uint8_t {
    blank,       ///< nothing on it
    foreign,     ///< does not begin with '(': not a line of candump
    timestamp,   ///< neither "(seconds.fraction)" nor "(date time.fraction)", 3 to 9 digits of fraction
    interface,   ///< missing, or not as wire::is_interface_name has it: no part of it is taken for a frame
    identifier,  ///< not 3 or 8 hexadecimal digits, or out of range
    data,        ///< neither '#' nor "[length]", no hexadecimal digit, half a byte, or more behind the frame
    length,      ///< more than 8 bytes, or a length that CAN FD does not have
    too_long,    ///< more than kLineBytesMax bytes
    truncated,   ///< the file ends within the line
};
[[nodiscard]] constexpr std::array<const char*, 9> names_of(LineFault) {
    return {"line_blank", "line_foreign", "line_timestamp", "line_interface", "line_identifier",
            "line_data",  "line_length",  "line_too_long",  "line_truncated"};
}

/// The longest line that candump shows has 282 bytes: colour 10, stamp 31, interface 17, direction 8,
/// identifier 12, length 6, data 192, colour 4, CR and LF.
inline constexpr std::size_t kLineBytesMax = 320;

/// The entry in `line`, which has no line feed; a carriage return at its end and colours are taken off, and a
/// direction mark ("R", "T") behind the frame is allowed. Dates are taken for UTC. Never returns `too_long`
/// or `truncated`. Any bytes are safe.
[[nodiscard]] Result<LogEntry, LineFault> parse_line(std::string_view line);

/// The same line again, with a line feed. The stamp is cut to whole microseconds. Asserts what `LogEntry`
/// promises, and that the frame's length exists in its format.
[[nodiscard]] std::string format_line(const LogEntry& entry);

}  // namespace octoskin::candump
