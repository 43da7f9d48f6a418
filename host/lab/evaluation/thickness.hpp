// How thick the solids of a world are: thin ones are those that a depth update loses first.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hw/sim/world/solid.hpp"

namespace octoskin::evaluation {

/// A rod's class is by its thickness: below 9, 18, 50 and 100 mm. A board is at most 40 mm thick.
enum class ThicknessClass : std::uint8_t {
    rod_5_8_mm,
    rod_10_16_mm,
    rod_20_40_mm,
    rod_70_90_mm,
    board,
    other
};
inline constexpr std::size_t kThicknessClasses = 6;
inline constexpr std::array<ThicknessClass, kThicknessClasses> kEveryThickness{
    ThicknessClass::rod_5_8_mm,   ThicknessClass::rod_10_16_mm, ThicknessClass::rod_20_40_mm,
    ThicknessClass::rod_70_90_mm, ThicknessClass::board,        ThicknessClass::other};

/// "rod_5_8_mm".
[[nodiscard]] std::string_view name_of(ThicknessClass thickness) noexcept;

/// Edges of a box round a solid, turned with it, ascending, metres: its least width, its least width across
/// that, and its width across both. Exact for boxes and cylinders; other round solids may come out a few per
/// cent wider. O(vertices + triangles), about 0.5 us each.
[[nodiscard]] std::array<double, 3> extents_of(const sim::Solid& solid);

/// By the extents a <= b of the box, and its third edge c:
/// - board: a <= 40 mm and b at least 100 mm or 3 a
/// - rod: else, a < 100 mm, b < 3 a, and c at least 2 b (long) or below 100 mm (small, such as a ball)
/// - other: all else, and a plane, which has no thickness
[[nodiscard]] ThicknessClass thickness_class(const std::array<double, 3>& extents_m) noexcept;

struct Thickness {
    ThicknessClass of_class = ThicknessClass::other;
    double thickness_m = 0.0;  ///< the least extent; infinity for a plane, as it may be a wall
};
[[nodiscard]] Thickness thickness_of(const sim::Solid& solid);

}  // namespace octoskin::evaluation
