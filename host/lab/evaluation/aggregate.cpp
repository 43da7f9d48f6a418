#include "host/lab/evaluation/aggregate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace octoskin::evaluation {
namespace {

bool is_same_map(const Run& a, const Run& b) {
    return a.configuration == b.configuration && a.map == b.map;
}

/// All runs of one map, by seed.
std::vector<const Run*> runs_like(std::span<const Run> runs, const Run& example) {
    std::vector<const Run*> found;
    for (const auto& run : runs) {
        if (is_same_map(run, example)) {
            found.push_back(&run);
        }
    }
    std::ranges::sort(found, {}, &Run::seed);
    assert(std::ranges::adjacent_find(found, {}, &Run::seed) == found.end());
    return found;
}

void add_bins(Calibration& sum, const Calibration& addend) {
    for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i].count += addend[i].count;
        sum[i].probability_sum += addend[i].probability_sum;
        sum[i].occupied_count += addend[i].occupied_count;
    }
}

void add_seen(std::optional<SeenPool>& pool, const SeenMetrics& addend) {
    if (!pool) pool.emplace();
    for (std::size_t i = 0; i < kThicknessClasses; ++i) pool->by_class[i].add(addend.by_class[i]);
    pool->too_coarse.add(addend.too_coarse);
}

MapSummary summarise_map(const std::vector<const Run*>& runs) {
    MapSummary summary;
    summary.configuration = runs.front()->configuration;
    summary.map = runs.front()->map;
    for (const auto* run : runs) {
        summary.seeds.push_back(run->seed);
        add_bins(summary.calibration, run->metrics.calibration);
        summary.free_calibration.add(run->metrics.free_calibration);
        if (run->metrics.seen) add_seen(summary.seen, *run->metrics.seen);
    }
    for (const auto& field : metric_fields()) {
        std::vector<std::optional<double>> per_seed;
        per_seed.reserve(runs.size());
        for (const auto* run : runs) {
            per_seed.push_back(field.value(run->metrics));
        }
        summary.metrics.emplace(field.name, summarise(std::move(per_seed)));
    }
    return summary;
}

std::optional<std::size_t> position_of(const std::vector<std::uint64_t>& seeds, std::uint64_t seed) {
    const auto found = std::ranges::find(seeds, seed);
    return found == seeds.end() ? std::nullopt : std::optional<std::size_t>(found - seeds.begin());
}

std::vector<std::string> configurations_of(std::span<const MapSummary> summaries) {
    std::vector<std::string> names;
    for (const auto& summary : summaries) {
        if (std::ranges::find(names, summary.configuration) == names.end()) {
            names.push_back(summary.configuration);
        }
    }
    return names;
}

void add_difference(std::vector<PairedDifference>& differences, const MapSummary* minuend,
                    const MapSummary* subtrahend) {
    if (minuend != nullptr && subtrahend != nullptr) {
        differences.push_back(paired_difference(*minuend, *subtrahend));
    }
}

}  // namespace

Summary summarise(std::vector<std::optional<double>> per_seed) {
    double sum = 0.0;
    double count = 0.0;
    for (const auto& value : per_seed) {
        sum += value.value_or(0.0);
        count += value ? 1.0 : 0.0;
    }
    Summary summary{std::nullopt, std::nullopt, std::move(per_seed)};
    if (count < 1.0) {
        return summary;
    }
    summary.mean = sum / count;
    if (count < 2.0) {
        return summary;
    }
    double squares = 0.0;
    for (const auto& value : summary.per_seed) {
        const double deviation = value ? *value - *summary.mean : 0.0;
        squares += deviation * deviation;
    }
    summary.sd = std::sqrt(squares / (count - 1.0));
    return summary;
}

const Summary& MapSummary::at(std::string_view metric) const {
    const auto found = metrics.find(metric);
    assert(found != metrics.end());
    return found->second;
}

bool has_group(const MetricSummaries& metrics, MetricGroup group) {
    return std::ranges::any_of(metric_fields(), [&](const MetricField& field) {
        return field.group == group && metrics.find(field.name)->second.mean;
    });
}

std::vector<MapSummary> aggregate(std::span<const Run> runs) {
    std::vector<MapSummary> summaries;
    for (const auto& run : runs) {
        if (find_map(summaries, run.configuration, run.map) == nullptr) {
            summaries.push_back(summarise_map(runs_like(runs, run)));
        }
    }
    return summaries;
}

const MapSummary* find_map(std::span<const MapSummary> summaries, std::string_view configuration,
                           std::string_view map) {
    const auto found = std::ranges::find_if(summaries, [&](const MapSummary& summary) {
        return summary.configuration == configuration && summary.map == map;
    });
    return found == summaries.end() ? nullptr : &*found;
}

PairedDifference paired_difference(const MapSummary& minuend, const MapSummary& subtrahend) {
    PairedDifference difference;
    difference.name =
        minuend.configuration + "/" + minuend.map + " - " + subtrahend.configuration + "/" + subtrahend.map;
    for (const auto& [metric, of_minuend] : minuend.metrics) {
        const Summary& of_subtrahend = subtrahend.at(metric);
        std::vector<std::optional<double>> per_seed;
        std::vector<std::uint64_t> seeds;
        for (std::size_t i = 0; i < minuend.seeds.size(); ++i) {
            const auto j = position_of(subtrahend.seeds, minuend.seeds[i]);
            if (!j) {
                continue;
            }
            const auto& a = of_minuend.per_seed[i];
            const auto& b = of_subtrahend.per_seed[*j];
            per_seed.push_back(a && b ? std::optional(*a - *b) : std::nullopt);
            seeds.push_back(minuend.seeds[i]);
        }
        difference.seeds = std::move(seeds);
        difference.metrics.emplace(metric, summarise(std::move(per_seed)));
    }
    return difference;
}

std::vector<PairedDifference> standard_differences(std::span<const MapSummary> summaries) {
    std::vector<PairedDifference> differences;
    const auto names = configurations_of(summaries);
    for (const auto& name : names) {
        const auto* fused = find_map(summaries, name, "fused");
        add_difference(differences, fused, find_map(summaries, name, "depth"));
        add_difference(differences, fused, find_map(summaries, name, "proximity"));
    }
    for (std::size_t later = 1; later < names.size(); ++later) {
        for (std::size_t earlier = 0; earlier < later; ++earlier) {
            add_difference(differences, find_map(summaries, names[later], "fused"),
                           find_map(summaries, names[earlier], "fused"));
        }
    }
    return differences;
}

}  // namespace octoskin::evaluation
