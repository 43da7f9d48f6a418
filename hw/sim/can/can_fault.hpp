// Faults of frames as data: which frames, from which one on, how many, and the effect.
#pragma once

#include <cstdint>
#include <optional>

#include "common/wire/can_frame.hpp"

namespace octoskin::sim {

enum class CanFaultKind : std::uint8_t {
    drop,       ///< no controller receives it, nor does the tap
    duplicate,  ///< every controller receives it twice
    corrupt,    ///< one bit arrives flipped, past CAN's own checksum
    delay,      ///< every controller receives it later
    disturb,    ///< its sender detects an error, no controller receives it; repeated unless bus-off
};

struct CanFault {
    CanFaultKind kind = CanFaultKind::drop;
    std::optional<std::uint32_t> can_id{};  ///< empty: every frame matches
    std::uint32_t after = 0;                ///< this many matching frames pass first
    std::uint32_t count = 1;                ///< then this many are hit
    std::uint32_t every = 1;                ///< only every n-th matching frame from there on
    std::uint16_t bit = 0;                  ///< corrupt: index into the payload, modulo its length
    std::int64_t delay_us = 0;              ///< delay

    /// Whether the fault hits the `match`-th matching frame, counted from 0.
    [[nodiscard]] constexpr bool hits(std::uint32_t match) const {
        if (match < after || every == 0) return false;
        const std::uint32_t since = match - after;
        return since % every == 0 && since / every < count;
    }
};

}  // namespace octoskin::sim
