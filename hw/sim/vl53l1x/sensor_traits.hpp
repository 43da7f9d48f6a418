// Properties of a correct part that no public document states and that a driver must not assume. For one part
// or for all.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"

namespace octoskin::sim {

/// A register that accepts writes but reads other values in the bits of the mask.
struct MisreadRegister {
    std::uint16_t index = 0;
    std::uint8_t value = 0;
    std::uint8_t mask = 0xFF;
    [[nodiscard]] constexpr std::uint8_t read(std::uint8_t held) const noexcept {
        return static_cast<std::uint8_t>((held & ~mask) | (value & mask));
    }
    friend constexpr bool operator==(const MisreadRegister&, const MisreadRegister&) = default;
};

/// Properties that a correct part may have; no public document states them.
struct SensorTraits {
    std::vector<MisreadRegister> misread{};
    /// Each range takes longer than its budget by a random time up to this.
    Microseconds range_spread{0};
    /// Additional time if there is a target.
    Microseconds range_step{0};
    /// Time from the first acknowledge until the boot loads all registers, including 0x0001, and sets bit 0
    /// of 0xE5: earlier writes are lost.
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

/// Merges the traits of all entries that apply: all registers, and the greatest of each time.
[[nodiscard]] SensorTraits traits_of(const std::vector<TraitsOf>& all, std::uint8_t node_id,
                                     std::uint8_t sensor);

/// "sensor=3,register=71,reads=12,mask=255,range_spread_us=0,range_step_us=0,boot_load_us=0", several
/// registers one after the other; without `node_id`, which the node knows itself.
[[nodiscard]] std::string to_text(const TraitsOf& traits);
/// Parses that text, in any order, zeros may be left out; empty if it is not valid.
[[nodiscard]] std::optional<TraitsOf> parse_traits(std::string_view text);

}  // namespace octoskin::sim
