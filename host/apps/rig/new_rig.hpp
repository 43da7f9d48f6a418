// Writes a rig for a robot: it loads, and only the sensors' poses are left to measure.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/rig/sensor_ring.hpp"
#include "host/apps/robot/given_robot.hpp"

namespace octoskin {

struct NewRig {
    GivenRobot robot;               ///< its URDF
    std::string base_link;          ///< empty: the root
    std::vector<SensorRing> rings;  ///< none: four sensors on the last link that moves, at its origin
    std::string robot_in_rig;       ///< the URDF as the rig names it
    std::string board_in_rig;
};

/// The rig's text, with comments. Boards have 16 sensors at most, on all of their buses in turn. Errors: the
/// robot cannot be read or fitted; no moving joint, or more than the rig can have; those of places_of(); more
/// than 34 sensors.
[[nodiscard]] Result<std::string, AppError> new_rig_text(const NewRig& request);

}  // namespace octoskin
