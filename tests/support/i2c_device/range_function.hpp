// What a served sensor sees, as a function of the machine's monotonic clock: so a test knows the truth.
#pragma once

#include <optional>
#include <string>

#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::test {

/// The true range in millimetres at a time of CLOCK_MONOTONIC; `text` is one of
///   none                            nothing in sight
///   constant:MM                     a wall
///   triangle:NEAR:FAR:PERIOD_MS     from NEAR at time 0 to FAR at half the period and back; NEAR <= FAR
///   file:PATH                       as the file's first line says now, which is one of the above
/// Outer empty optional: not understood (or, of a file, not readable).
[[nodiscard]] std::optional<std::optional<double>> true_range_mm(const std::string& text, sim::SimTime time);

/// A scene that sees that range well: sigma 5 mm, 16 Mcps, no noise. What is not understood is out of sight.
[[nodiscard]] sim::RangingScene scene_of(std::string text);

}  // namespace octoskin::test
