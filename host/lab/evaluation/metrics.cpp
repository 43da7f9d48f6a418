#include "host/lab/evaluation/metrics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/lab/evaluation/marked_voxels.hpp"

namespace octoskin::evaluation {
namespace {

/// The log loss of a wrong prediction with probability 1 is infinite. A map with clamped log-odds makes no
/// such prediction.
constexpr double kProbabilityFloor = 1e-9;

std::optional<double> ratio(double part, double whole) {
    return whole > 0.0 ? std::optional(part / whole) : std::nullopt;
}
std::optional<double> ratio(std::uint64_t part, std::uint64_t whole) {
    return ratio(static_cast<double>(part), static_cast<double>(whole));
}

/// Sums over the voxels that are not interior to a solid.
struct SurfaceSums {
    std::uint64_t voxels = 0;
    std::uint64_t known = 0;
    std::uint64_t surface = 0;
    MarkedVoxels marked;
    std::uint64_t occluded = 0;
    std::uint64_t marked_occluded = 0;
    std::uint64_t object = 0;  ///< occluded, and of a hidden object
    std::uint64_t marked_object = 0;
    double log_loss = 0.0;
    double squared_error = 0.0;
    Calibration calibration;
};

void add_prediction(SurfaceSums& sums, const MapVoxel& voxel, bool is_surface) {
    const double predicted = static_cast<double>(voxel.probability);
    const double of_outcome = is_surface ? predicted : 1.0 - predicted;
    sums.log_loss -= std::log(std::max(of_outcome, kProbabilityFloor));
    sums.squared_error += (1.0 - of_outcome) * (1.0 - of_outcome);
    if (voxel.occupancy != Occupancy::unknown) {
        const auto bin = static_cast<std::size_t>(predicted * static_cast<double>(kCalibrationBins));
        auto& of_bin = sums.calibration[std::min(bin, kCalibrationBins - 1)];
        of_bin.count += 1;
        of_bin.probability_sum += predicted;
        of_bin.occupied_count += is_surface ? 1 : 0;
    }
}

void add_voxel(SurfaceSums& sums, const MapVoxel& voxel, const SurfaceVoxel& truth) {
    if (truth.is_interior) {
        return;
    }
    const bool is_marked = voxel.occupancy == Occupancy::occupied;
    const bool is_object = truth.is_occluded && truth.is_hidden_object;
    sums.voxels += 1;
    sums.known += voxel.occupancy != Occupancy::unknown ? 1 : 0;
    sums.surface += truth.is_surface ? 1 : 0;
    sums.marked.add(voxel.occupancy, truth);
    sums.occluded += truth.is_occluded ? 1 : 0;
    sums.marked_occluded += is_marked && truth.is_occluded ? 1 : 0;
    sums.object += is_object ? 1 : 0;
    sums.marked_object += is_marked && is_object ? 1 : 0;
    add_prediction(sums, voxel, truth.is_surface);
}

void add_table_one(Metrics& metrics, Occupancy map, Occupancy truth) {
    const bool is_marked = map == Occupancy::occupied;
    if (truth == Occupancy::occupied) {
        metrics.occupied += is_marked ? 1 : 0;
        metrics.missed += map == Occupancy::unknown ? 1 : 0;
        metrics.lost += map == Occupancy::free ? 1 : 0;
        return;
    }
    metrics.incorrect += is_marked ? 1 : 0;
    metrics.free += map == Occupancy::free && truth == Occupancy::free ? 1 : 0;
}

void set_ratios(Metrics& metrics, const SurfaceSums& sums) {
    const MarkedVoxels& marked = sums.marked;
    const std::uint64_t united = marked.all + sums.surface - marked.on_surface;
    metrics.precision = marked.precision();
    metrics.recall = ratio(marked.on_surface, sums.surface);
    metrics.f1 = ratio(2 * marked.on_surface, marked.all + sums.surface);
    metrics.iou = ratio(marked.on_surface, united);
    metrics.precision_tolerant = marked.precision_tolerant();
    metrics.occluded_recall = ratio(sums.marked_occluded, sums.occluded);
    metrics.object_recall = ratio(sums.marked_object, sums.object);
    metrics.coverage = ratio(sums.known, sums.voxels);
    metrics.log_loss = ratio(sums.log_loss, static_cast<double>(sums.voxels));
    metrics.brier = ratio(sums.squared_error, static_cast<double>(sums.voxels));
    metrics.calibration = sums.calibration;
}

std::optional<double> as_double(std::uint64_t count) {
    return static_cast<double>(count);
}

/// A figure of the seen surfaces; empty without a camera.
template <std::optional<double> SeenMetrics::*kFigure>
std::optional<double> seen(const Metrics& metrics) {
    return metrics.seen ? (*metrics.seen).*kFigure : std::nullopt;
}

/// A figure of the comparison with the camera's map; empty without one.
template <std::optional<double> BesideCamera::*kFigure>
std::optional<double> beside_camera(const Metrics& metrics) {
    return metrics.beside_camera ? (*metrics.beside_camera).*kFigure : std::nullopt;
}

constexpr std::array<MetricField, 26> kFields{{
    {"occupied", MetricGroup::camera_truth, true, true,
     [](const Metrics& m) { return as_double(m.occupied); }},
    {"free", MetricGroup::camera_truth, true, true, [](const Metrics& m) { return as_double(m.free); }},
    {"missed", MetricGroup::camera_truth, true, false, [](const Metrics& m) { return as_double(m.missed); }},
    {"incorrect", MetricGroup::camera_truth, true, false,
     [](const Metrics& m) { return as_double(m.incorrect); }},
    {"lost", MetricGroup::camera_truth, true, false, [](const Metrics& m) { return as_double(m.lost); }},
    {"precision", MetricGroup::surfaces, false, true, [](const Metrics& m) { return m.precision; }},
    {"recall", MetricGroup::surfaces, false, true, [](const Metrics& m) { return m.recall; }},
    {"f1", MetricGroup::surfaces, false, true, [](const Metrics& m) { return m.f1; }},
    {"iou", MetricGroup::surfaces, false, true, [](const Metrics& m) { return m.iou; }},
    {"precision_tolerant", MetricGroup::surfaces, false, true,
     [](const Metrics& m) { return m.precision_tolerant; }},
    {"occluded_recall", MetricGroup::surfaces, false, true,
     [](const Metrics& m) { return m.occluded_recall; }},
    {"object_recall", MetricGroup::surfaces, false, true, [](const Metrics& m) { return m.object_recall; }},
    {"coverage", MetricGroup::surfaces, false, true, [](const Metrics& m) { return m.coverage; }},
    {"log_loss", MetricGroup::probabilities, false, false, [](const Metrics& m) { return m.log_loss; }},
    {"brier", MetricGroup::probabilities, false, false, [](const Metrics& m) { return m.brier; }},
    {"seen_occupied", MetricGroup::seen, false, true, seen<&SeenMetrics::seen_occupied>},
    {"seen_free", MetricGroup::seen, false, false, seen<&SeenMetrics::seen_free>},
    {"seen_unknown", MetricGroup::seen, false, false, seen<&SeenMetrics::seen_unknown>},
    {"f1_seen", MetricGroup::seen, false, true, seen<&SeenMetrics::f1_seen>},
    {"f1_noise_free", MetricGroup::seen, false, true, seen<&SeenMetrics::f1_noise_free>},
    {"body_2cm", MetricGroup::seen, false, false, seen<&SeenMetrics::body_2cm>},
    {"body_5cm", MetricGroup::seen, false, false, seen<&SeenMetrics::body_5cm>},
    {"availability", MetricGroup::seen, false, true, seen<&SeenMetrics::availability_5cm>},
    {"lost_beyond_camera", MetricGroup::beside_camera, true, false,
     [](const Metrics& m) {
         return m.beside_camera ? as_double(m.beside_camera->lost_beyond_camera) : std::nullopt;
     }},
    {"freed_occupied", MetricGroup::beside_camera, false, false,
     beside_camera<&BesideCamera::freed_occupied>},
    {"freed_seen_unknown", MetricGroup::beside_camera, false, false,
     beside_camera<&BesideCamera::freed_seen_unknown>},
}};

}  // namespace

std::optional<double> CalibrationBin::mean_predicted() const noexcept {
    return ratio(probability_sum, static_cast<double>(count));
}

std::optional<double> CalibrationBin::observed_fraction() const noexcept {
    return ratio(occupied_count, count);
}

VoxelGrid<MapVoxel> sample_map(const FusedMap& map, const KeyBox& box) {
    VoxelGrid<MapVoxel> samples(box);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const VoxelKey key = box.key_at(i);
        if (const auto log_odds = map.log_odds(key)) {
            samples[i] = {map.occupancy(key), 1.0F / (1.0F + std::exp(-*log_odds))};
        }
    }
    return samples;
}

Metrics compute_metrics(const VoxelGrid<MapVoxel>& map, const Truth& truth) {
    assert(map.box() == truth.region() && truth.surface.box() == truth.region());
    Metrics metrics;
    SurfaceSums sums;
    for (std::size_t i = 0; i < map.size(); ++i) {
        add_table_one(metrics, map[i].occupancy, truth.camera[i]);
        add_voxel(sums, map[i], truth.surface[i]);
    }
    set_ratios(metrics, sums);
    return metrics;
}

BesideCamera compare(const VoxelGrid<MapVoxel>& map, const VoxelGrid<MapVoxel>& camera_map,
                     const Truth& truth) {
    assert(map.box() == truth.region() && camera_map.box() == truth.region());
    BesideCamera result;
    std::uint64_t occupied = 0;
    std::uint64_t freed_occupied = 0;
    for (std::size_t i = 0; i < map.size(); ++i) {
        const bool is_free = map[i].occupancy == Occupancy::free;
        const Occupancy of_camera = camera_map[i].occupancy;
        if (truth.camera[i] == Occupancy::occupied && of_camera == Occupancy::unknown)
            result.lost_beyond_camera += is_free ? 1 : 0;
        if (truth.surface[i].is_surface && of_camera == Occupancy::occupied) {
            occupied += 1;
            freed_occupied += is_free ? 1 : 0;
        }
    }
    result.freed_occupied = ratio(freed_occupied, occupied);
    if (!truth.seen) return result;
    std::uint64_t unknown = 0;
    std::uint64_t freed_unknown = 0;
    for (const SeenVoxel& voxel : truth.seen->voxels) {
        if (camera_map.at(voxel.key).occupancy != Occupancy::unknown) continue;
        unknown += 1U;
        freed_unknown += map.at(voxel.key).occupancy == Occupancy::free ? 1U : 0U;
    }
    result.freed_seen_unknown = ratio(freed_unknown, unknown);
    return result;
}

Metrics evaluate(const FusedMap& map, const Truth& truth, const MissUnits& units,
                 const FusedMap* camera_map) {
    assert(map.resolution_m() == truth.resolution_m);
    const VoxelGrid<MapVoxel> samples = sample_map(map, truth.region());
    Metrics metrics = compute_metrics(samples, truth);
    metrics.free_calibration = free_calibration(map, units, truth.surface);
    if (truth.seen) metrics.seen = seen_metrics(map, *truth.seen);
    if (camera_map != nullptr)
        metrics.beside_camera = compare(samples, sample_map(*camera_map, truth.region()), truth);
    return metrics;
}

std::string_view title_of(MetricGroup group) noexcept {
    switch (group) {
        case MetricGroup::camera_truth:
            return "camera truth";
        case MetricGroup::surfaces:
            return "surfaces";
        case MetricGroup::probabilities:
            return "probabilities";
        case MetricGroup::seen:
            return "seen by the camera";
        case MetricGroup::beside_camera:
            break;
    }
    return "beside the camera's map";
}

std::span<const MetricField> metric_fields() noexcept {
    return kFields;
}

}  // namespace octoskin::evaluation
