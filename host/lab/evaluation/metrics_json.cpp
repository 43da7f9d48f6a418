#include <cassert>
#include <nlohmann/json.hpp>

#include "host/apps/profile/named_mapping.hpp"
#include "host/lab/evaluation/results.hpp"

namespace octoskin::evaluation {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json summary_json(const Summary& summary) {
    Json per_seed = Json::array();
    for (const auto& value : summary.per_seed) {
        per_seed.push_back(number(value));
    }
    return {{"mean", number(summary.mean)}, {"sd", number(summary.sd)}, {"per_seed", std::move(per_seed)}};
}

/// In the order of `metric_fields`, as in the printed table.
Json metrics_object(const MetricSummaries& metrics) {
    Json object = Json::object();
    for (const auto& field : metric_fields()) {
        if (const auto found = metrics.find(field.name); found != metrics.end()) {
            object[std::string(field.name)] = summary_json(found->second);
        }
    }
    return object;
}

Json calibration_json(const Calibration& calibration) {
    Json bins = Json::array();
    for (std::size_t i = 0; i < calibration.size(); ++i) {
        const auto& bin = calibration[i];
        bins.push_back({{"from", static_cast<double>(i) / static_cast<double>(kCalibrationBins)},
                        {"to", static_cast<double>(i + 1) / static_cast<double>(kCalibrationBins)},
                        {"count", bin.count},
                        {"mean_predicted", number(bin.mean_predicted())},
                        {"observed_fraction", number(bin.observed_fraction())}});
    }
    return bins;
}

Json free_bins_json(const FreeBins& bins) {
    Json json = Json::array();
    for (const FreeBin& bin : bins) json.push_back({{"voxels", bin.voxels}, {"surface", bin.surface}});
    return json;
}

Json body_json(const BodyTests& tests) {
    return {{"spheres", tests.spheres}, {"free", tests.free}};
}

Json shares_json(const SeenShares& shares) {
    return {{"voxels", shares.voxels},
            {"occupied", shares.occupied},
            {"free", shares.free},
            {"unknown", shares.unknown},
            {"body_2cm", body_json(shares.body_2cm)},
            {"body_5cm", body_json(shares.body_5cm)}};
}

Json seen_json(const SeenPool& seen) {
    Json classes = Json::object();
    for (std::size_t i = 0; i < kThicknessClasses; ++i)
        classes[std::string(name_of(kEveryThickness[i]))] = shares_json(seen.by_class[i]);
    classes["too_coarse"] = shares_json(seen.too_coarse);
    return classes;
}

Json unknown_json(const UnknownSpace& space) {
    Json json = {{"radius_m", space.region.radius_m},
                 {"region_m3", space.region_m3},
                 {"samples", Json::array()},
                 {"pockets", Json::array()}};
    for (const UnknownSample& sample : space.samples)
        json["samples"].push_back(
            {{"t_s", sample.t_s}, {"depth_m3", number(sample.depth_m3)}, {"fused_m3", sample.fused_m3}});
    for (const UnknownPocket& pocket : space.pockets)
        json["pockets"].push_back({{"volume_m3", pocket.volume_m3},
                                   {"centre_m", {pocket.centre.x(), pocket.centre.y(), pocket.centre.z()}}});
    return json;
}

Json run_json(const Results& results) {
    Json run = {{"seeds", results.seeds}, {"paired", Json::object()}, {"calibration", Json::object()}};
    for (const auto& difference : results.paired) {
        run["paired"][difference.name] = {{"seeds", difference.seeds},
                                          {"metrics", metrics_object(difference.metrics)}};
    }
    for (const auto& map : results.maps) {
        run["calibration"][map.configuration][map.map] = calibration_json(map.calibration);
        run["free_calibration"][map.configuration][map.map] = {
            {"images", free_bins_json(map.free_calibration.images)},
            {"beams", free_bins_json(map.free_calibration.beams)},
            {"sum", free_bins_json(map.free_calibration.sum)}};
        if (map.seen) run["thickness"][map.configuration][map.map] = seen_json(*map.seen);
    }
    run["times"] = Json::array();
    for (const auto& time : results.times) {
        run["times"].push_back({{"part", time.part}, {"wall_s", time.wall_s}, {"cpu_s", time.cpu_s}});
    }
    if (results.unknown_space) run["unknown_space"] = unknown_json(*results.unknown_space);
    run["provenance"] = Json::object();
    for (const auto& [key, value] : results.provenance) {
        run["provenance"][key] = value;
    }
    return run;
}

}  // namespace

std::string metrics_json(const Results& results) {
    Json root = Json::object();
    for (const auto& map : results.maps) {
        assert(map.configuration != kReservedName);
        root[map.configuration][map.map] = metrics_object(map.metrics);
    }
    root[std::string(kReservedName)] = run_json(results);
    // A path or a name may hold bytes that are not UTF-8; JSON may not.
    return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace octoskin::evaluation
