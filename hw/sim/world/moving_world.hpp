// A world in which some models come, go and are moved.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hw/sim/world/world.hpp"

namespace octoskin::sim {

/// From when on a model stands where; until the next one.
struct ModelPlace {
    double from_s = 0.0;
    bool is_there = true;
    Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< from where the SDF has it
    /// On the way to the next place, in a straight line at one speed, instead of standing until then. For two
    /// places at which it is there.
    bool moves_on = false;
    friend bool operator==(const ModelPlace&, const ModelPlace&) = default;
};

/// Places in the order of their times; before the first the model is where the SDF has it.
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

    /// The world as it is then; a motion goes on in steps of `kStep_s`. Until it is asked for another
    /// instant. If something has moved since the last one some 5 ms, else next to nothing. Not from two
    /// threads at once.
    [[nodiscard]] const World& at(double time_s);
    static constexpr double kStep_s = 0.01;

    [[nodiscard]] const std::vector<ModelMotion>& motions() const noexcept { return motions_; }

  private:
    [[nodiscard]] std::vector<ModelPlace> places_at(double time_s) const;

    std::vector<Solid> solids_;
    std::vector<ModelMotion> motions_;
    std::vector<ModelPlace> places_;  ///< for which `world_` was made
    std::unique_ptr<World> world_;
};

}  // namespace octoskin::sim
