#include "hw/sim/scenario/motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin::sim {
namespace {

constexpr double kLongest_s = 600.0;
constexpr double kFurthest_m = 20.0;  ///< a larger value is probably in millimetres

ModelPlace read_place(const rig::Value& value, const std::string& path, const ModelPlace* before) {
    const rig::Table table(value, path, {"at_s", "is_there", "offset_m", "moves_on"});
    ModelPlace place;
    place.from_s = table.number("at_s", {-kLongest_s, kLongest_s});
    place.is_there = table.flag("is_there", true);
    place.moves_on = table.flag("moves_on", false);
    if (table.find("offset_m") != nullptr)
        place.offset_m =
            rig::read_position(table.require("offset_m"), table.path_of("offset_m"), kFurthest_m);
    if (before != nullptr && place.from_s <= before->from_s)
        table.fail("at_s", fmt::format("expected later than the place before, {} s, found {}", before->from_s,
                                       place.from_s));
    if (before != nullptr && before->moves_on && !place.is_there)
        rig::fail(value, path,
                  "the place before moves on to here, but the model is not there; give it a place first");
    return place;
}

ModelMotion read_model(const rig::Value& value, const std::string& path, const std::vector<Solid>& solids) {
    const rig::Table table(value, path, {"model", "places"});
    ModelMotion motion;
    motion.model = table.element_name("model");
    if (std::ranges::find(solids, motion.model, &Solid::model) == solids.end())
        table.fail("model", "the world has no model '" + motion.model + "'");
    const auto& places = rig::read_list(table.require("places"), table.path_of("places"));
    for (std::size_t i = 0; i < places.size(); ++i) {
        motion.places.push_back(read_place(places[i], fmt::format("{}[{}]", table.path_of("places"), i),
                                           i > 0 ? &motion.places.back() : nullptr));
    }
    if (motion.places.empty()) table.fail("places", "expected at least one place");
    const auto has_no_way = [](const ModelPlace& place) { return place.moves_on && !place.is_there; };
    if (motion.places.back().moves_on || std::ranges::any_of(motion.places, has_no_way))
        table.fail("places", "a model that moves on must be there, and needs a next place");
    return motion;
}

std::vector<ModelMotion> read_checked_motion(const FilePlace& file, const std::vector<Solid>& solids) {
    const rig::Value document = rig::load_document(file, rig::Quotes::withheld);
    const rig::Table top(document, "", {"models"});
    const auto& models = rig::read_list(top.require("models"), "models");
    std::vector<ModelMotion> motions;
    for (std::size_t i = 0; i < models.size(); ++i) {
        ModelMotion motion = read_model(models[i], fmt::format("models[{}]", i), solids);
        if (std::ranges::find(motions, motion.model, &ModelMotion::model) != motions.end())
            rig::fail(models[i], fmt::format("models[{}]", i), "model '" + motion.model + "' comes twice");
        motions.push_back(std::move(motion));
    }
    return motions;
}

}  // namespace

Result<std::vector<ModelMotion>, rig::RigError> read_motion(const FilePlace& file,
                                                            const std::vector<Solid>& solids) {
    try {
        return read_checked_motion(file, solids);
    } catch (const rig::Fault& fault) {
        return unexpected(fault.error);
    }
}

}  // namespace octoskin::sim
