// The true range of a served sensor as a function of the machine's monotonic clock, so that a test knows it.
#pragma once

#include <optional>
#include <string>

#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::test {

/// The true range in millimetres at a time of CLOCK_MONOTONIC; `text` is one of
///   none                            nothing in sight
///   constant:MM                     a wall
///   triangle:NEAR:FAR:PERIOD_MS     from NEAR at time 0 to FAR at half the period and back; NEAR <= FAR
///   file:PATH                       the present first line of the file, which is one of the above
/// Outer empty optional: cannot be parsed (or, for a file, not readable).
[[nodiscard]] std::optional<std::optional<double>> true_range_mm(const std::string& text, sim::SimTime time);

/// A scene with that range: sigma 5 mm, 16 Mcps, no noise. For a text that cannot be parsed nothing is in
/// sight.
[[nodiscard]] sim::RangingScene scene_of(std::string text);

}  // namespace octoskin::test
