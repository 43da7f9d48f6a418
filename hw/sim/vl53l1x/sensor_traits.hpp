// How a part may be that is as its maker made it: what no public document says, and what a driver must not
// presume. On one part, or on all.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"

namespace octoskin::sim {

/// A register that takes what is written, and reads otherwise in the bits of the mask.
struct MisreadRegister {
    std::uint16_t index = 0;
    std::uint8_t value = 0;
    std::uint8_t mask = 0xFF;
    [[nodiscard]] constexpr std::uint8_t read(std::uint8_t held) const noexcept {
        return static_cast<std::uint8_t>((held & ~mask) | (value & mask));
    }
    friend constexpr bool operator==(const MisreadRegister&, const MisreadRegister&) = default;
};

/// How a part may be though nothing is wrong with it; nothing public says.
struct SensorTraits {
    std::vector<MisreadRegister> misread{};
    /// Each range takes longer than its budget, by anything up to this, without a rhythm.
    Microseconds range_spread{0};
    /// And by this much more if there is a target.
    Microseconds range_step{0};
    /// So long after it first answers its boot loads all registers, 0x0001 among them, and only then sets bit
    /// 0 of 0xE5: what was written before is gone.
    Microseconds boot_load{0};
    friend bool operator==(const SensorTraits&, const SensorTraits&) = default;
};

/// Traits of one sensor of one node, or of all of them.
struct TraitsOf {
    std::optional<std::uint8_t> node_id{};
    std::optional<std::uint8_t> sensor{};
    SensorTraits traits{};
    friend bool operator==(const TraitsOf&, const TraitsOf&) = default;
};

/// Adds the traits of all that are meant: registers to registers, and the greater of two times.
[[nodiscard]] SensorTraits traits_of(const std::vector<TraitsOf>& all, std::uint8_t node_id,
                                     std::uint8_t sensor);

/// "sensor=3,register=71,reads=12,mask=255,range_spread_us=0,range_step_us=0,boot_load_us=0", several
/// registers one after the other; without `node_id`: of a node that knows itself.
[[nodiscard]] std::string to_text(const TraitsOf& traits);
/// That text, in any order, what is 0 left out; empty if it is none.
[[nodiscard]] std::optional<TraitsOf> parse_traits(std::string_view text);

}  // namespace octoskin::sim
