#include "host/lab/study/judged_maps.hpp"

#include "host/core/mapping/free_evidence.hpp"
#include "host/core/pipeline/fed_map.hpp"
#include "host/lab/evaluation/metrics.hpp"

namespace octoskin {

std::vector<evaluation::Run> judge_maps(const Playback& playback, const NamedMapping& configuration,
                                        std::uint64_t seed, const evaluation::Truth& truth) {
    const std::span<const FedMap> maps = playback.pipeline.maps();
    const bool has_camera = !playback.rig.cameras.empty();
    const FusedMap* const camera_map = has_camera ? find_map(maps, MapFeed::camera) : nullptr;
    const MissUnits units = miss_units(configuration.mapping);
    std::vector<evaluation::Run> runs;
    for (const auto& [feed, map] : maps) {
        if (!has_camera && feed != MapFeed::ranges) continue;
        const FusedMap* const beside = feed == MapFeed::both ? camera_map : nullptr;
        runs.push_back({configuration.name, std::string(name_of(feed)), seed,
                        evaluation::evaluate(map, truth, units, beside)});
    }
    return runs;
}

}  // namespace octoskin
