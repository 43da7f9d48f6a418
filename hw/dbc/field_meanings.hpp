// What the fields of each message mean, what their named values mean, and when each message is sent: the
// texts of the tables in docs/protocol.md. Those of fields are also comments of the DBC.
#pragma once

#include <span>
#include <string_view>

#include "common/wire/frame_type.hpp"

namespace octoskin::dbc {

struct FieldMeaning {
    wire::FrameType type;
    std::string_view field;  ///< its name in common/wire/layout.hpp, without an index
    std::string_view
        text;  ///< without the unit, the sign, the limits and the named values: signals have them
};
[[nodiscard]] std::span<const FieldMeaning> field_meanings() noexcept;

/// Empty if there is none. O(fields).
[[nodiscard]] std::string_view meaning_of(wire::FrameType type, std::string_view field) noexcept;

/// A named value of a field. Names that say enough have no meaning here.
struct ValueMeaning {
    wire::FrameType type;
    std::string_view field;
    std::string_view value;  ///< its name in common/wire/names.hpp
    std::string_view text;
    std::string_view detail = {};  ///< what `detail_field` then has
};
[[nodiscard]] std::span<const ValueMeaning> value_meanings() noexcept;

/// The field whose content depends on the value of `field`: `argument` of a command's code, and `fault_where`
/// of a kind of fault. Else empty.
[[nodiscard]] std::string_view detail_field(wire::FrameType type, std::string_view field) noexcept;

struct SendingTime {
    wire::FrameType type;
    std::string_view text;
};
[[nodiscard]] std::span<const SendingTime> sending_times() noexcept;

}  // namespace octoskin::dbc
