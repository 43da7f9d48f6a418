// The field of view of a VL53L1X as a bundle of sub-rays, and the range computed from their echoes.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/config/node_config.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::sim {

/// The sub-rays of a cone: a square grid over the cone's disc, sensor frame. Their weights fall off as a
/// Gaussian of the angle to the axis.
class ConeView {
  public:
    explicit ConeView(const rig::Cone& cone);

    /// Unit vectors, row by row, neighbours beside each other.
    [[nodiscard]] std::span<const Eigen::Vector3d> directions_sensor() const noexcept { return directions_; }
    /// What each sub-ray contributes to a zone. Over the whole array they sum to 1. A zone gets the share of
    /// each sub-ray that the lens, with its Gaussian blur, projects on the zone rather than on the rest of
    /// the array. The shares of zones that tile the array add up to the whole signal; light from beyond the
    /// array's edge falls on the zones at that edge. About 3 us.
    [[nodiscard]] std::vector<double> weights(const Roi& zone) const;

  private:
    struct Place {
        std::size_t column = 0;
        std::size_t row = 0;
    };

    double blur_rad_;
    std::vector<double> angles_rad_;  ///< of the grid's columns about y, and of its rows about x
    std::vector<Place> places_;       ///< of each sub-ray in the grid
    std::vector<Eigen::Vector3d> directions_;
    std::vector<double> weights_;  ///< of the whole array
};

/// The echo of one sub-ray: its share of the signal, in the units of echo_signal().
struct Echo {
    double range_m = 0.0;
    double signal = 0.0;
};

/// weight * reflectivity * cos(incidence) / range^2, for a Lambertian surface. A plane that fills the whole
/// array's view at 1 m, head-on, gives its reflectivity. Below 1 cm the value is that of 1 cm.
[[nodiscard]] double echo_signal(double weight, double reflectivity, double cos_incidence, double range_m);

/// The nearest 15 cm of range with at least 30 % of the signal of the strongest 15 cm: their signal, and the
/// mean of their ranges weighted by signal. Empty if there is no signal. Sorts `echoes`.
[[nodiscard]] std::optional<Echo> nearest_peak(std::vector<Echo>& echoes);

}  // namespace octoskin::sim
