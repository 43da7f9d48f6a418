// Sensors around a link, on the surface of its body, looking outward.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "hw/rigfile/robot_description.hpp"

namespace octoskin {

/// On a robot.
inline constexpr std::size_t kRigSensorsMax = 34;

/// --ring LINK,N,Z
struct SensorRing {
    std::string link;
    std::size_t count = 0;
    double height_m = 0.0;  ///< along the link's z
};

/// The value of the option; a link's name may contain commas. Error (bad_argument): another form, a count
/// that is not 1 to 34, a height beyond 2 m.
[[nodiscard]] Result<SensorRing, Error> sensor_ring_of(std::string_view text);

struct RingPlace {
    Eigen::Vector3d p_link = Eigen::Vector3d::Zero();  ///< on the surface, rounded outward to a millimetre
    double azimuth_deg = 0.0;  ///< about the link's z, from its x: the sensor looks that way
};

/// Evenly spread around the middle of the body's cut at that height. `body`: all capsules of the robot.
/// Error (no_data): the link has no body at that height.
[[nodiscard]] Result<std::vector<RingPlace>, Error> places_of(const SensorRing& ring,
                                                              std::span<const rig::Capsule> body);

}  // namespace octoskin
