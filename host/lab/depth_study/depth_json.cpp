#include <nlohmann/json.hpp>

#include "host/lab/depth_study/depth_study.hpp"

namespace octoskin::depth_study {
namespace {

using Json = nlohmann::ordered_json;
using evaluation::SeenMetrics;
using evaluation::SeenShares;

Json value_json(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json subject_json(const Subject& subject) {
    return {{"scenario", subject.scenario},
            {"noise", subject.noise},
            {"configuration", subject.configuration},
            {"sigma_factor", subject.sigma_factor},
            {"seed", subject.seed}};
}

Json shares_json(const SeenShares& shares) {
    return {{"voxels", shares.voxels},
            {"occupied", shares.occupied},
            {"free", shares.free},
            {"unknown", shares.unknown},
            {"body_2cm", {{"spheres", shares.body_2cm.spheres}, {"free", shares.body_2cm.free}}},
            {"body_5cm", {{"spheres", shares.body_5cm.spheres}, {"free", shares.body_5cm.free}}}};
}

Json thickness_json(const SeenMetrics& seen) {
    Json classes = Json::object();
    for (std::size_t i = 0; i < evaluation::kThicknessClasses; ++i)
        classes[std::string(name_of(evaluation::kEveryThickness[i]))] = shares_json(seen.by_class[i]);
    classes["too_coarse"] = shares_json(seen.too_coarse);
    return classes;
}

Json free_json(const evaluation::FreeBins& bins) {
    Json json = Json::array();
    for (const auto& bin : bins) json.push_back({{"voxels", bin.voxels}, {"surface", bin.surface}});
    return json;
}

Json seen_json(const SeenFigures& figures) {
    const SeenMetrics& seen = figures.seen;
    Json json = subject_json(figures.subject);
    json["t_s"] = figures.t_s;
    json["precision"] = value_json(seen.precision);
    json["precision_tolerant"] = value_json(seen.precision_tolerant);
    json["f1_seen"] = value_json(seen.f1_seen);
    json["f1_noise_free"] = value_json(seen.f1_noise_free);
    json["seen_occupied"] = value_json(seen.seen_occupied);
    json["seen_free"] = value_json(seen.seen_free);
    json["seen_unknown"] = value_json(seen.seen_unknown);
    json["body_2cm"] = value_json(seen.body_2cm);
    json["body_5cm"] = value_json(seen.body_5cm);
    json["availability"] = value_json(seen.availability_5cm);
    json["all"] = shares_json(seen.all);
    json["thickness"] = thickness_json(seen);
    json["free_by_images"] = free_json(figures.free.images);
    return json;
}

Json hand_json(const HandFigures& figures) {
    Json json = subject_json(figures.subject);
    json["path"] = name_of(figures.path);
    json["speed_m_per_s"] = figures.speed_m_per_s;
    json["voxels"] = figures.voxels;
    json["occupied"] = figures.occupied;
    json["free"] = figures.free;
    json["appears_s"] = value_json(figures.appears_s);
    json["leaves_s"] = value_json(figures.leaves_s);
    return json;
}

std::string_view name_of(DepthScene scene) {
    switch (scene) {
        case DepthScene::stationary:
            return "stationary";
        case DepthScene::moving:
            return "moving";
        case DepthScene::hand:
            return "hand";
    }
    return {};
}

}  // namespace

std::string depth_json(const DepthResults& results) {
    Json root = {{"program", results.program},
                 {"rig", results.rig},
                 {"scene", name_of(results.scene)},
                 {"figures", Json::array()}};
    for (const SeenFigures& figures : results.seen) root["figures"].push_back(seen_json(figures));
    for (const HandFigures& figures : results.hand) root["figures"].push_back(hand_json(figures));
    // A name may hold bytes that are not UTF-8; JSON may not.
    return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace octoskin::depth_study
