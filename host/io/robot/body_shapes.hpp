// Which shapes of a link become its body.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/rigfile/link_shapes.hpp"

namespace octoskin {

/// What the body of a link is made of.
enum class BodySource : std::uint8_t {
    nothing,    ///< the link has no shape; a box of no size is none
    collision,  ///< its <collision> elements
    visual,     ///< its <visual> elements: it moves, and has no <collision>
};
[[nodiscard]] const char* name_of(BodySource source) noexcept;

[[nodiscard]] BodySource source_of(const rig::ShapedLink& link);
/// The shapes of that source.
[[nodiscard]] const std::vector<rig::LinkShape>& body_shapes(const rig::ShapedLink& link);
/// Whether capsules are fitted to the shape: a mesh, or a box.
[[nodiscard]] bool is_fitted(const rig::LinkShape& shape) noexcept;

}  // namespace octoskin
