// Why a query is refused, as errors for its sender.
#pragma once

#include <span>
#include <string>

#include "host/core/kinematics/robot_model.hpp"
#include "host/core/query/robot_query.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/errors/error.hpp"

namespace octoskin {

[[nodiscard]] Error error_of(const RobotQueryFault& fault, double padding_m);
/// `of`: the posture, such as "configuration 2".
[[nodiscard]] Error error_of(const PostureFault& fault, const HostRig& rig, const RobotModel& robot,
                             std::span<const double> position, const std::string& of);

}  // namespace octoskin
