// The robot that a user gives.
#pragma once

#include <filesystem>
#include <vector>

#include "host/io/robot/mesh_places.hpp"

namespace octoskin {

struct GivenRobot {
    std::filesystem::path urdf = {};         ///< in place of the rig's; empty: the rig's
    std::vector<PackagePath> packages = {};  ///< where its meshes are
};

}  // namespace octoskin
