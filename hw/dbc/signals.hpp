// The fields of each message as a list of named bits, from the same declaration as the codec
// (common/wire/layout.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/wire/frame_type.hpp"
#include "common/wire/layout.hpp"

namespace octoskin::dbc {

struct Signal {
    std::string name;        ///< with the index of a repeated field: "range_2"
    std::string field = {};  ///< without it: "range"; empty for version and checksum, which all frames have
    std::optional<unsigned> index = std::nullopt;
    /// Linear bit number of the lowest bit. For a high-byte-first signal: of the lowest bit of its first
    /// byte.
    unsigned start = 0;
    unsigned bits = 0;
    bool is_signed = false;
    bool is_high_byte_first = false;  ///< a CRC-16
    wire::Unit unit = wire::Unit::none;
    std::uint64_t min = 0;  ///< `min` and `max`: smallest and largest valid raw value of an unsigned signal
    std::uint64_t max = 0;
    bool is_selector = false;  ///< its value selects which other signals are present

    struct SelectorRange {
        unsigned min = 0;
        unsigned max = 0;
    };
    std::optional<SelectorRange> only_if =
        std::nullopt;  ///< present only while the selector is in this range
    std::vector<std::pair<unsigned, std::string>> values = {};  ///< raw value -> name
    std::string_view meaning = {};                              ///< of the field: field_meanings.hpp
};

/// All signals of a frame type in wire order: version first, checksum last. A field that several layouts of
/// one type have in the same place is one signal. RANGE_FD has one checksum signal per length.
[[nodiscard]] std::vector<Signal> signals_of(wire::FrameType type);

}  // namespace octoskin::dbc
