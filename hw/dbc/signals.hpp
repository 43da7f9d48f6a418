// Every message's fields as a list of named bits: the same walk over common/wire/layout.hpp as the codec's,
// written down instead of carried out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/wire/frame_type.hpp"
#include "common/wire/layout.hpp"

namespace octoskin::dbc {

struct Signal {
    std::string name;
    /// Linear bit number of the lowest bit; of a high-byte-first signal, of its first byte's lowest bit.
    unsigned start = 0;
    unsigned bits = 0;
    bool is_signed = false;
    bool is_high_byte_first = false;  ///< a CRC-16
    wire::Unit unit = wire::Unit::none;
    std::uint64_t min = 0;  ///< smallest and largest raw value that is valid, if unsigned
    std::uint64_t max = 0;
    bool is_selector = false;  ///< its value tells which of the others are there

    struct SelectorRange {
        unsigned min = 0;
        unsigned max = 0;
    };
    std::optional<SelectorRange> only_if = std::nullopt;        ///< there only while the selector is within
    std::vector<std::pair<unsigned, std::string>> values = {};  ///< raw value -> name
};

/// All signals of an assigned type in wire order, version first, checksum last. What several layouts of one
/// type have in the same place is one signal. The checksum of a RANGE_FD is another signal for each length.
[[nodiscard]] std::vector<Signal> signals_of(wire::FrameType type);

}  // namespace octoskin::dbc
