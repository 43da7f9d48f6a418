// The experiment's robot, for the tests of the arm.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace octoskin::sim {

inline const std::filesystem::path kPandaUrdf =
    std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/robots/panda.urdf";
inline const std::vector<std::string> kPandaJoints = {"panda_joint1", "panda_joint2", "panda_joint3",
                                                      "panda_joint4", "panda_joint5", "panda_joint6",
                                                      "panda_joint7"};

}  // namespace octoskin::sim
