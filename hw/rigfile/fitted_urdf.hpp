// A robot description whose links have capsules in place of meshes and boxes.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "hw/rigfile/robot_description.hpp"

namespace octoskin::rig {

/// The names of the <collision> elements begin so. Such a capsule reaches beyond the link.
inline constexpr std::string_view kFittedName = "octoskin_fit_";

/// What replaces the meshes and boxes of a link.
struct FittedBody {
    std::vector<Capsule> capsules;  ///< may be empty, for a link with boxes of no size alone
    bool is_of_visual = false;      ///< fitted to its <visual>s, for want of a <collision>
};

/// The URDF `text` in which each link of `bodies` has these capsules and no <collision> that is a mesh or a
/// box. If they are of its <visual>s, then each <visual> mesh is removed, and other <visual>s but boxes
/// become a <collision>, too. A <visual> that no body was fitted to stays: links_without_body.hpp compares
/// the body with it, and no reader of a rig opens its mesh. Everything else stays, but for the layout. A
/// capsule is a cylinder with a sphere of its radius at each end, which each tool reads. Radii are rounded
/// up: the body only grows, by at most 3 micrometres. Errors: those of parse_robot().
[[nodiscard]] Result<std::string, Error> urdf_with_bodies(const std::filesystem::path& file,
                                                          const std::string& text,
                                                          const std::map<std::string, FittedBody>& bodies);

}  // namespace octoskin::rig
