// One accepted range, placed: the value that the integrator takes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/rig/beam_optics.hpp"
#include "host/core/rig/sensor_id.hpp"

namespace octoskin {

/// Which zone of which sensor of which node.
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
        Eigen::Vector3d::UnitZ();  ///< unit vector along the sensor's z axis, map frame
    /// Measured range along `direction_map` in metres; empty for a beam without return.
    std::optional<double> range_m;
    double sigma_m = 0.0;
    double clear_limit_m = 0.0;  ///< without return: space may be cleared up to here; 0 = not at all
    BeamOptics optics = {};      ///< what it sees about `direction_map`
    /// How the sensor is turned: the same for all of its zones.
    Eigen::Matrix3d R_map_sensor = Eigen::Matrix3d::Identity();
};

/// From when a beam was measured; below 0 before that.
[[nodiscard]] constexpr double seconds_since(const Beam& beam, HostTime now) noexcept {
    constexpr double kSecond_ns = 1e9;
    return static_cast<double>(now.ns - beam.captured.ns) / kSecond_ns;
}

}  // namespace octoskin
