#include "host/lab/evaluation/results.hpp"

#include <algorithm>

namespace octoskin::evaluation {

Results collect(std::span<const Run> runs, std::vector<PartTime> times,
                std::vector<std::pair<std::string, std::string>> provenance) {
    Results results;
    results.maps = aggregate(runs);
    results.paired = standard_differences(results.maps);
    results.times = std::move(times);
    results.provenance = std::move(provenance);
    for (const auto& run : runs) {
        results.seeds.push_back(run.seed);
    }
    std::ranges::sort(results.seeds);
    results.seeds.erase(std::unique(results.seeds.begin(), results.seeds.end()), results.seeds.end());
    return results;
}

}  // namespace octoskin::evaluation
