// A world in which some models appear, disappear and move.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hw/sim/world/world.hpp"

namespace octoskin::sim {

/// The place of a model from a time on, until its next place.
struct ModelPlace {
    double from_s = 0.0;
    bool is_there = true;
    Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< from its place in the SDF
    /// Moves to the next place in a straight line at constant speed instead of staying until then. Requires
    /// that the model is there at both places.
    bool moves_on = false;
    friend bool operator==(const ModelPlace&, const ModelPlace&) = default;
};

/// Places in the order of their times; before the first the model is at its place in the SDF.
struct ModelMotion {
    std::string model;
    std::vector<ModelPlace> places;
    friend bool operator==(const ModelMotion&, const ModelMotion&) = default;
};

/// Where a model is, and whether it is there.
[[nodiscard]] ModelPlace place_at(const ModelMotion& motion, double time_s);

class MovingWorld {
  public:
    /// Each model is one of the solids' (asserted).
    MovingWorld(std::vector<Solid> solids, std::vector<ModelMotion> motions);

    /// The world at a time; motion has steps of `kStep_s`. The reference is valid until the next call. About
    /// 5 ms if a model has moved since the last call, else almost nothing. Not from two threads at once.
    [[nodiscard]] const World& at(double time_s);
    static constexpr double kStep_s = 0.01;

    [[nodiscard]] const std::vector<ModelMotion>& motions() const noexcept { return motions_; }

  private:
    [[nodiscard]] std::vector<ModelPlace> places_at(double time_s) const;

    std::vector<Solid> solids_;
    std::vector<ModelMotion> motions_;
    std::vector<ModelPlace> places_;  ///< of `world_`
    std::unique_ptr<World> world_;
};

}  // namespace octoskin::sim
