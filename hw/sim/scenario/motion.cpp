#include "hw/sim/scenario/motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/table.hpp"
#include "hw/sim/scenario/scenario_keys.hpp"

namespace octoskin::sim {
namespace {

ModelPlace read_place(const rig::Value& value, const std::string& path, const ModelPlace* before) {
    const rig::Table table(value, path, keys::kPlace);
    ModelPlace place;
    place.from_s = table.number(keys::world_motion::kAt);
    place.is_there = table.flag(keys::world_motion::kIsThere);
    place.moves_on = table.flag(keys::world_motion::kMovesOn);
    if (table.find(keys::world_motion::kOffset) != nullptr)
        place.offset_m = rig::read_position(table, keys::world_motion::kOffset);
    if (before != nullptr && place.from_s <= before->from_s)
        table.fail(keys::world_motion::kAt,
                   {ErrorCode::out_of_range,
                    fmt::format("expected later than the place before, {} s", before->from_s),
                    fmt::format("{}", place.from_s)});
    if (before != nullptr && before->moves_on && !place.is_there)
        rig::fail(value, path,
                  {.code = ErrorCode::conflict,
                   .what = "the place before moves on to here, but the model is not there",
                   .remedy = "give it a place first"});
    return place;
}

ModelMotion read_model(const rig::Value& value, const std::string& path, const std::vector<Solid>& solids) {
    const rig::Table table(value, path, keys::kModel);
    ModelMotion motion;
    motion.model = table.text(keys::world_motion::kModel);
    if (std::ranges::find(solids, motion.model, &Solid::model) == solids.end())
        table.fail(keys::world_motion::kModel,
                   {ErrorCode::unknown_name, "expected a model of the world", "'" + motion.model + "'"});
    const auto& places = table.list(keys::world_motion::kPlaces);
    const std::string places_path = table.path_of(keys::world_motion::kPlaces);
    for (std::size_t i = 0; i < places.size(); ++i) {
        motion.places.push_back(read_place(places[i], fmt::format("{}[{}]", places_path, i),
                                           i > 0 ? &motion.places.back() : nullptr));
    }
    if (motion.places.empty())
        table.fail(keys::world_motion::kPlaces,
                   {ErrorCode::missing_key, "expected at least one place, found none"});
    const auto has_no_way = [](const ModelPlace& place) { return place.moves_on && !place.is_there; };
    if (motion.places.back().moves_on || std::ranges::any_of(motion.places, has_no_way))
        table.fail(keys::world_motion::kPlaces,
                   {ErrorCode::conflict, "a model that moves on must be there, and needs a next place"});
    return motion;
}

std::vector<ModelMotion> read_checked_motion(const FilePlace& file, const std::vector<Solid>& solids) {
    const rig::Value document = rig::load_document(file, rig::Quotes::withheld);
    const rig::Table top(document, "", keys::kWorldMotion);
    const auto& models = top.list(keys::world_motion::kModels);
    std::vector<ModelMotion> motions;
    for (std::size_t i = 0; i < models.size(); ++i) {
        const std::string path = fmt::format("{}[{}]", top.path_of(keys::world_motion::kModels), i);
        ModelMotion motion = read_model(models[i], path, solids);
        if (std::ranges::find(motions, motion.model, &ModelMotion::model) != motions.end())
            rig::fail(models[i], path,
                      {ErrorCode::duplicate, "expected each model once", "'" + motion.model + "' again"});
        motions.push_back(std::move(motion));
    }
    return motions;
}

}  // namespace

Result<std::vector<ModelMotion>, Error> read_motion(const FilePlace& file, const std::vector<Solid>& solids) {
    try {
        return read_checked_motion(file, solids);
    } catch (const Error& error) {
        return unexpected(error);
    }
}

}  // namespace octoskin::sim
