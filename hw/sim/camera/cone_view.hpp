// The field of view of a VL53L1X as a bundle of sub-rays, and how their echoes become one range.
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
    /// What each sub-ray contributes to a zone. Over the whole array they sum to 1. A zone gets of each
    /// sub-ray the part that the lens, whose blur is Gaussian, lets fall on the zone rather than on the rest
    /// of the array: zones that tile the array share its signal without a remainder, and what arrives from
    /// beyond the array's edge falls on the zones at that edge. About 3 us.
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

/// What one sub-ray brings back: its share of the signal, in the units of echo_signal().
struct Echo {
    double range_m = 0.0;
    double signal = 0.0;
};

/// weight * reflectivity * cos(incidence) / range^2, of a surface that scatters as Lambert's; a plane that
/// fills the whole array's view at 1 m, head-on, gives its reflectivity. Nearer than 1 cm it grows no more.
[[nodiscard]] double echo_signal(double weight, double reflectivity, double cos_incidence, double range_m);

/// The nearest 15 cm of range that hold at least 30 % of the signal of those 15 cm that hold most: their
/// signal, and the mean of their ranges weighted by it. Empty if there is no signal. Sorts `echoes`.
[[nodiscard]] std::optional<Echo> nearest_peak(std::vector<Echo>& echoes);

}  // namespace octoskin::sim
