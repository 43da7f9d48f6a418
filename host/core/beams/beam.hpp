// One accepted range with its place in the map: the input of the integrator.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/rig/beam_optics.hpp"
#include "host/core/rig/sensor_id.hpp"

namespace octoskin {

/// Identifies a zone of a sensor of a node.
struct BeamSource {
    std::uint8_t node_id = 0;
    std::uint8_t sensor = 0;
    std::uint8_t zone = 0;
    [[nodiscard]] constexpr SensorId sensor_id() const noexcept { return {node_id, sensor}; }
    friend constexpr auto operator<=>(const BeamSource&, const BeamSource&) = default;
};

struct Beam {
    BeamSource source;
    HostTime captured;
    Eigen::Vector3d p_map_sensor = Eigen::Vector3d::Zero();  ///< origin, map frame, metres
    Eigen::Vector3d direction_map =
        Eigen::Vector3d::UnitZ();  ///< unit vector along the zone's axis, map frame
    /// Measured range along `direction_map` in metres; empty for a beam without return.
    std::optional<double> range_m;
    double sigma_m = 0.0;
    double clear_limit_m = 0.0;  ///< without return: space is cleared up to here at most; 0 = not at all
    BeamOptics optics = {};      ///< the cone about `direction_map`
    /// The sensor's orientation: the same for all of its zones.
    Eigen::Matrix3d R_map_sensor = Eigen::Matrix3d::Identity();
};

/// Seconds from the capture of the beam to `now`; negative if `now` is earlier.
[[nodiscard]] constexpr double seconds_since(const Beam& beam, HostTime now) noexcept {
    constexpr double kSecond_ns = 1e9;
    return static_cast<double>(now.ns - beam.captured.ns) / kSecond_ns;
}

}  // namespace octoskin
