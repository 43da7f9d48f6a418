#include "hw/sim/world/moving_world.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace octoskin::sim {

ModelPlace place_at(const ModelMotion& motion, double time_s) {
    ModelPlace place;
    for (std::size_t i = 0; i < motion.places.size() && motion.places[i].from_s <= time_s; ++i) {
        place = motion.places[i];
        if (!place.moves_on || i + 1 == motion.places.size()) continue;
        const ModelPlace& next = motion.places[i + 1];
        const double way = std::min(1.0, (time_s - place.from_s) / (next.from_s - place.from_s));
        place.offset_m += way * (next.offset_m - place.offset_m);
    }
    return place;
}

MovingWorld::MovingWorld(std::vector<Solid> solids, std::vector<ModelMotion> motions)
    : solids_(std::move(solids)), motions_(std::move(motions)) {
    for ([[maybe_unused]] const ModelMotion& motion : motions_)
        assert(std::ranges::find(solids_, motion.model, &Solid::model) != solids_.end());
}

std::vector<ModelPlace> MovingWorld::places_at(double time_s) const {
    constexpr double kRounding = 1e-9;
    const double stepped_s = kStep_s * std::floor(time_s / kStep_s + kRounding);
    std::vector<ModelPlace> places;
    for (const ModelMotion& motion : motions_) {
        // Whether a model is there is exact in time.
        ModelPlace place = place_at(motion, time_s);
        if (place.moves_on) place.offset_m = place_at(motion, std::max(stepped_s, place.from_s)).offset_m;
        place.from_s = 0.0;  // values without effect on the picture must not differ
        place.moves_on = false;
        places.push_back(place);
    }
    return places;
}

const World& MovingWorld::at(double time_s) {
    std::vector<ModelPlace> places = places_at(time_s);
    if (world_ != nullptr && places == places_) return *world_;
    std::vector<Solid> solids;
    for (const Solid& solid : solids_) {
        const auto motion = std::ranges::find(motions_, solid.model, &ModelMotion::model);
        if (motion == motions_.end()) {
            solids.push_back(solid);
            continue;
        }
        const ModelPlace& place = places[static_cast<std::size_t>(motion - motions_.begin())];
        if (!place.is_there) continue;
        solids.push_back(solid);
        for (Eigen::Vector3d& vertex : solids.back().vertices) vertex += place.offset_m;
    }
    world_ = std::make_unique<World>(std::move(solids));
    places_ = std::move(places);
    return *world_;
}

}  // namespace octoskin::sim
