#include "host/io/mapping/mapping_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <type_traits>

namespace octoskin {
namespace {

/// The depth updates, each also the name of the configuration that is built round it.
constexpr std::array<std::pair<std::string_view, DepthUpdate>, 4> kDepthUpdates{
    {{"paper", DepthUpdate::paper},
     {"robust", DepthUpdate::robust},
     {"fast", DepthUpdate::fast},
     {"denoised", DepthUpdate::denoised}}};
constexpr std::array<std::pair<std::string_view, RangeUpdate>, 2> kRangeUpdates{
    {{"ray", RangeUpdate::ray}, {"cone", RangeUpdate::cone}}};

/// The member of a configuration that is reached by these members, one below the other.
template <auto... Members>
MappingValue at(MappingConfig& config) {
    return &(config.*....*Members);
}

constexpr std::array kMappingKeys = {
    MappingKey{"map.resolution_m",
               "m",
               {0.001, 10},
               at<&MappingConfig::map, &MapConfig::resolution_m>,
               "edge of a voxel; [cost below](#cost-of-the-resolution)"},
    MappingKey{"map.log_odds_min",
               "log-odds",
               {-100, 0},
               at<&MappingConfig::map, &MapConfig::log_odds_min>,
               "lower limit. A lower one needs more hits until a new object is occupied"},
    MappingKey{"map.log_odds_max",
               "log-odds",
               {0, 100},
               at<&MappingConfig::map, &MapConfig::log_odds_max>,
               "upper limit. A higher one needs more misses until a removed object is free"},
    MappingKey{
        "map.log_odds_passed_max",
        "log-odds",
        {-100, 100},
        at<&MappingConfig::map, &MapConfig::log_odds_passed_max>,
        "limit for a voxel that all rays of an image pass: a removed object is free after 8 images, with "
        "1.5 after 5"},
    MappingKey{"map.log_odds_hit_min",
               "log-odds",
               {-100, 100},
               at<&MappingConfig::map, &MapConfig::log_odds_hit_min>,
               "least value of a voxel that an image marks occupied: a new object is occupied at once, with "
               "-0.4 after 2 or 3"},
    MappingKey{"map.log_odds_occupied",
               "log-odds",
               {-100, 100},
               at<&MappingConfig::map, &MapConfig::log_odds_occupied>,
               "occupied from here on; above `log_odds_min`, at most `log_odds_max`"},
    MappingKey{"map.memory_max_mib",
               "MiB",
               {1, 1000000},
               at<&MappingConfig::map, &MapConfig::memory_max_mib>,
               "at this size the map takes no new space, and the status reports it. Counts of cones take up "
               "to 3/16 of it in addition, times of voxels up to 9/16"},
    MappingKey{"age.stale_after_s",
               "s",
               {0, 7200},
               at<&MappingConfig::map, &MapConfig::age, &AgeModel::stale_after_s>,
               "a voxel not confirmed by a sensor for this long is "
               "[stale](how-to/query.md#how-old-the-evidence-is); 0: never"},
    MappingKey{"age.unknown_after_s",
               "s",
               {0, 7200},
               at<&MappingConfig::map, &MapConfig::age, &AgeModel::unknown_after_s>,
               "and after this long unknown, counts included, in saved files too, whether anything is "
               "measured or not; more than `stale_after_s`; 0: never ([below](#age-of-counts))"},
    MappingKey{"proximity_hit.log_odds_offset",
               "log-odds",
               {-100, 100},
               at<&MappingConfig::model, &UpdateModel::proximity, &HitModel::offset>,
               "a range sensor's hit adds offset - slope * range"},
    MappingKey{"proximity_hit.log_odds_slope_per_m",
               "log-odds per m",
               {-100, 100},
               at<&MappingConfig::model, &UpdateModel::proximity, &HitModel::slope_per_m>,
               "slope"},
    MappingKey{"proximity_hit.range_min_m",
               "m",
               {0, 100},
               at<&MappingConfig::model, &UpdateModel::proximity, &HitModel::range_min_m>,
               "a nearer hit adds nothing"},
    MappingKey{"proximity_hit.is_range_min_exclusive",
               "",
               {},
               at<&MappingConfig::model, &UpdateModel::proximity, &HitModel::is_min_exclusive>,
               "nor does a hit at exactly this range"},
    MappingKey{"depth_hit.log_odds_offset",
               "log-odds",
               {-100, 100},
               at<&MappingConfig::model, &UpdateModel::depth, &HitModel::offset>,
               "the same four keys for the depth camera"},
    MappingKey{"depth_hit.log_odds_slope_per_m",
               "log-odds per m",
               {-100, 100},
               at<&MappingConfig::model, &UpdateModel::depth, &HitModel::slope_per_m>,
               "slope"},
    MappingKey{"depth_hit.range_min_m",
               "m",
               {0, 100},
               at<&MappingConfig::model, &UpdateModel::depth, &HitModel::range_min_m>,
               "a nearer hit adds nothing"},
    MappingKey{"depth_hit.is_range_min_exclusive",
               "",
               {},
               at<&MappingConfig::model, &UpdateModel::depth, &HitModel::is_min_exclusive>,
               "nor does a hit at exactly this range"},
    MappingKey{"miss_log_odds",
               "log-odds",
               {-100, 0},
               at<&MappingConfig::model, &UpdateModel::miss_log_odds>,
               "for each voxel that a beam passes"},
    MappingKey{"depth_update",
               "",
               {},
               at<&MappingConfig::depth_update>,
               "[effect of an image on a voxel](concepts/sensor-models.md#depth-images). `paper`: one term, "
               "the largest hit before any miss. `robust`: the mean of the terms of its beams. `fast`: the "
               "mean over the rays around its centre, at least 0 where a ray ends. `denoised`: as `paper`, "
               "of images averaged over time"},
    MappingKey{
        "depth_filter.is_enabled",
        "",
        {},
        at<&MappingConfig::depth_filter, &DepthFilterConfig::is_enabled>,
        "filters the image first; recommended with `robust` and `fast`, without effect with `denoised`"},
    MappingKey{"depth_filter.window_px",
               "pixels",
               {1, 7},
               at<&MappingConfig::depth_filter, &DepthFilterConfig::window>,
               "width and height of the window; odd"},
    MappingKey{"depth_filter.sigma_m",
               "m",
               {1e-06, 10},
               at<&MappingConfig::depth_filter, &DepthFilterConfig::sigma_m>,
               "the camera's noise, one standard deviation"},
    MappingKey{"depth_filter.gate_sigmas",
               "sigmas",
               {0, 1000},
               at<&MappingConfig::depth_filter, &DepthFilterConfig::gate_sigmas>,
               "values further from the centre's value are left out; times `sigma_m` at most 2 m"},
    MappingKey{"depth_filter.mean_sigmas",
               "sigmas",
               {0, 1000},
               at<&MappingConfig::depth_filter, &DepthFilterConfig::mean_sigmas>,
               "values within this of the median are averaged; times `sigma_m` at most 2 m"},
    MappingKey{"depth_filter.min_support",
               "pixels",
               {0, 48},
               at<&MappingConfig::depth_filter, &DepthFilterConfig::min_support>,
               "no value if no more than these remain; below `window_px`², the centre included"},
    MappingKey{"depth_denoiser.noise_m",
               "m",
               {1e-4, 1},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::noise, &DepthNoiseLaw::constant_m>,
               "with `depth_update: denoised`: the camera's noise, one standard deviation of a pixel at "
               "`noise_from_m`"},
    MappingKey{
        "depth_denoiser.noise_per_m",
        "1/m",
        {0, 1},
        at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::noise, &DepthNoiseLaw::quadratic_per_m>,
        "its growth with the square of the distance from `noise_from_m`; 0.0019 for a Kinect"},
    MappingKey{"depth_denoiser.noise_from_m",
               "m",
               {0, 10},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::noise, &DepthNoiseLaw::from_m>,
               "see `noise_per_m`"},
    MappingKey{"depth_denoiser.bias_per_m",
               "1/m",
               {0, 0.1},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::noise, &DepthNoiseLaw::bias_per_m>,
               "the error that stays from image to image, by the square of the depth; 0.0015 for a Kinect"},
    MappingKey{"depth_denoiser.gate_sigmas",
               "sigmas",
               {0.1, 100},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::gate_sigmas>,
               "a value further from its pixel's mean is held back; two in a row begin a new mean"},
    MappingKey{"depth_denoiser.step_sigmas",
               "sigmas",
               {0.1, 100},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::step_sigmas>,
               "so does a step of the pixels around it that is larger"},
    MappingKey{"depth_denoiser.drift_sigmas",
               "sigmas",
               {0.1, 100},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::drift_sigmas>,
               "and a running mean of their steps that is larger"},
    MappingKey{"depth_denoiser.drift_memory",
               "",
               {0, 0.99},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::drift_memory>,
               "what this running mean keeps of itself from image to image"},
    MappingKey{"depth_denoiser.count_max",
               "images",
               {1, 10000},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::count_max>,
               "a mean weighs at most as much"},
    MappingKey{"depth_denoiser.pair_sigmas",
               "sigmas",
               {0.1, 100},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::pair_sigmas>,
               "opposite neighbours of a pixel that agree with it within this are averaged"},
    MappingKey{"depth_denoiser.min_support",
               "pixels",
               {0, 24},
               at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::support_min>,
               "a pixel with fewer further values and agreeing pixels has no value"},
    MappingKey{
        "depth_denoiser.doubt_sigmas",
        "sigmas",
        {0, 100},
        at<&MappingConfig::depth_denoiser, &DepthDenoiserConfig::doubt_sigmas>,
        "a pixel whose surface is nearer than this to the next voxel along the ray marks nothing if that "
        "voxel is certainly hit"},
    MappingKey{"moving_miss_log_odds",
               "log-odds",
               {-100, 0},
               at<&MappingConfig::moving_miss_log_odds>,
               "with `depth_update: denoised`: in place of `miss_log_odds` for images of a moving camera"},
    MappingKey{"range_update",
               "",
               {},
               at<&MappingConfig::range_update>,
               "[effect of a range](concepts/sensor-models.md#cones) of a sensor with a `cone` in the rig: "
               "one ray, or counts of hits and misses over the cone. All other sensors are rays"},
    MappingKey{"ray_end_sigmas",
               "sigmas",
               {0, 10},
               at<&MappingConfig::ray_end_sigmas>,
               "a ray frees nothing so many of its range's sigmas before its end, where its surface may be"},
    MappingKey{"cone.hit_range_max_m",
               "m",
               {0, 100},
               at<&MappingConfig::cone, &ConeModel::hit_range_max_m>,
               "a sensor that uses more than half of its SPADs at a time: a longer range frees space and "
               "marks nothing occupied"},
    MappingKey{"cone.cap_half_thickness_m",
               "m",
               {0, 1},
               at<&MappingConfig::cone, &ConeModel::cap_half_thickness_m>,
               "distance of the surface before and behind the range, at most:"},
    MappingKey{"cone.cap_sigmas",
               "sigmas",
               {0, 10},
               at<&MappingConfig::cone, &ConeModel::cap_sigmas>,
               "plus this many of the range's own sigmas"},
    MappingKey{"cone.cap_angle_share",
               "",
               {0, 1},
               at<&MappingConfig::cone, &ConeModel::cap_angle_share>,
               "angle of the cap off the axis, as a share of the angle where nothing is seen any more"},
    MappingKey{"cone.core_weight_min",
               "",
               {0.01, 0.999},
               at<&MappingConfig::cone, &ConeModel::core_weight_min>,
               "space is freed where the beam weighs at least this (1 on its axis): less frees more, and "
               "erases more"},
    MappingKey{"cone.core_margin_voxels",
               "voxels",
               {0, 2},
               at<&MappingConfig::cone, &ConeModel::core_margin_voxels>,
               "and this far beside it"},
    MappingKey{"cone.hit_mass",
               "hits",
               {0, 100},
               at<&MappingConfig::cone, &ConeModel::hit_mass>,
               "what one range adds to all voxels of its cap together"},
    MappingKey{"cone.miss_mass",
               "misses",
               {0, 100},
               at<&MappingConfig::cone, &ConeModel::miss_mass>,
               "what one range adds to each voxel that it frees"},
    MappingKey{"zone.hit_range_max_m",
               "m",
               {0, 100},
               at<&MappingConfig::zone, &ConeModel::hit_range_max_m>,
               "**the same keys for a [zone](concepts/sensor-models.md#cones) of at most half of the "
               "SPADs**; chosen for 3 x 3 zones of 6 x 6"},
    MappingKey{"zone.cap_half_thickness_m",
               "m",
               {0, 1},
               at<&MappingConfig::zone, &ConeModel::cap_half_thickness_m>,
               "as above"},
    MappingKey{
        "zone.cap_sigmas", "sigmas", {0, 10}, at<&MappingConfig::zone, &ConeModel::cap_sigmas>, "as above"},
    MappingKey{"zone.cap_angle_share",
               "",
               {0, 1},
               at<&MappingConfig::zone, &ConeModel::cap_angle_share>,
               "as above"},
    MappingKey{"zone.core_weight_min",
               "",
               {0.01, 0.999},
               at<&MappingConfig::zone, &ConeModel::core_weight_min>,
               "as above"},
    MappingKey{"zone.core_margin_voxels",
               "voxels",
               {0, 2},
               at<&MappingConfig::zone, &ConeModel::core_margin_voxels>,
               "as above"},
    MappingKey{"zone.hit_mass",
               "hits",
               {0, 100},
               at<&MappingConfig::zone, &ConeModel::hit_mass>,
               "**main setting for zones:** less for precision, more for recall"},
    MappingKey{
        "zone.miss_mass", "misses", {0, 100}, at<&MappingConfig::zone, &ConeModel::miss_mass>, "as above"},
    MappingKey{"standing.readings",
               "readings",
               {0, 8},
               at<&MappingConfig::standing, &StationaryModel::readings>,
               "of a [stationary sensor](concepts/stationary-sensors.md): this many of its last seven "
               "readings that agree mark a new object occupied at once; 0: never, 1 is refused"},
    MappingKey{"standing.hits",
               "hits",
               {0, 10000},
               at<&MappingConfig::standing, &StationaryModel::hits>,
               "hits that they leave a voxel at least, and no misses: more outlasts more readings and images "
               "that pass it"},
    MappingKey{"standing.angle_share",
               "",
               {0, 1},
               at<&MappingConfig::standing, &StationaryModel::angle_share>,
               "angle off the axis up to which they mark occupied, as a share of the angle where nothing is "
               "seen any more"},
    MappingKey{"standing.clears_after_s",
               "s",
               {0, 5},
               at<&MappingConfig::standing, &StationaryModel::clears_after_s>,
               "space that all readings of a zone over this time (at least three) see through, and that no "
               "other sensor sees, becomes free; 0: counting alone frees"},
    MappingKey{"counts.prior_hits",
               "hits",
               {0.001, 100},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::prior_hits>,
               "prior of an unknown voxel"},
    MappingKey{"counts.prior_misses",
               "misses",
               {0.001, 100},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::prior_misses>,
               "prior of an unknown voxel"},
    MappingKey{"counts.occupied_hits",
               "hits",
               {0, 10000},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::occupied_hits>,
               "hits equal to the camera's `log_odds_max`, in proportion below"},
    MappingKey{"counts.free_misses",
               "misses",
               {0, 10000},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::free_misses>,
               "misses equal to the camera's `log_odds_min`"},
    MappingKey{"counts.occupied_probability",
               "",
               {0.01, 0.99},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::occupied_probability>,
               "a voxel with counts is occupied from here on,"},
    MappingKey{"counts.hits_min",
               "hits",
               {0, 1000},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::hits_min>,
               "if it has this many hits, or the camera has it occupied. **Main setting:** more for "
               "precision, less for recall"},
    MappingKey{"counts.misses_min",
               "misses",
               {0, 1000},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::misses_min>,
               "a voxel that is neither occupied nor known otherwise is free with more, unknown with less"},
    MappingKey{"counts.counts_max",
               "",
               {1, 10000},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::counts_max>,
               "limit of hits and misses of a voxel together: less forgets sooner"},
    MappingKey{"counts.image_clears",
               "",
               {0, 1},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::image_clears>,
               "share of a voxel's hits that an image removes if all its rays pass the voxel"},
    MappingKey{"counts.image_marks",
               "",
               {0, 1},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::image_marks>,
               "share of a voxel's misses that an image removes if it marks the voxel occupied"},
    MappingKey{"counts.range_clears",
               "log-odds",
               {0, 100},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::range_clears>,
               "a range's miss takes this from a voxel's other log-odds, while they are above 0,"},
    MappingKey{"counts.range_clears_from",
               "misses",
               {0, 10000},
               at<&MappingConfig::map, &MapConfig::counts, &CountModel::range_clears_from>,
               "once the voxel has this many misses: for objects that left while the camera did not look"},
    MappingKey{"removes_robot_from_depth",
               "",
               {},
               at<&MappingConfig::removes_robot_from_depth>,
               "pixels on the robot's capsules mark nothing occupied"},
    MappingKey{"removes_robot_from_ranges",
               "",
               {},
               at<&MappingConfig::removes_robot_from_ranges>,
               "nor do ranges that end on them"},
    MappingKey{"reports_contradicting_sensors",
               "",
               {},
               at<&MappingConfig::reports_contradicting_sensors>,
               "compares ranges with the camera's image ([cross-check](concepts/cross-check.md)). Reports a "
               "sensor that contradicts it, or the camera, if one error of its pose or depth explains "
               "several contradictions"},
    MappingKey{"refuses_contradicting_sensors",
               "",
               {},
               at<&MappingConfig::refuses_contradicting_sensors>,
               "readings of a reported sensor neither mark occupied nor free until it agrees again; they "
               "count as `contradicts_camera`. Needs `reports_contradicting_sensors`"},
    MappingKey{"depth_range_max_m",
               "m",
               {0, 100},
               at<&MappingConfig::depth_range_max_m>,
               "a depth pixel with a larger range clears space up to here and marks nothing occupied; 0: no "
               "maximum"},
    MappingKey{"no_return_clear_m",
               "m",
               {0, 100},
               at<&MappingConfig::no_return_clear_m>,
               "a beam without return clears space up to here, never beyond its own limit; 0: no effect. A "
               "wide cone has many voxels there ([below](#cost-of-the-resolution))"},
    MappingKey{"depth_box_voxels_max",
               "voxels",
               {1000, 1073741824},
               at<&MappingConfig::depth_box_voxels_max>,
               "an image whose rays span a larger box is refused (`box_too_large`). 1 byte each with "
               "`paper` and `denoised`, 8 with `robust`, 1 bit with `fast` for each of its threads"},
};

template <class Words>
std::string joined(const Words& words) {
    std::string text;
    for (const auto& entry : words) text += (text.empty() ? "" : " or ") + std::string(entry.first);
    return text;
}

template <class Words, class Value>
std::string word_of(const Words& words, Value value) {
    return std::string(
        std::ranges::find(words, value, [](const auto& entry) { return entry.second; })->first);
}

}  // namespace

std::span<const MappingKey> mapping_keys() noexcept {
    return kMappingKeys;
}
std::span<const std::pair<std::string_view, DepthUpdate>> depth_update_words() noexcept {
    return kDepthUpdates;
}
std::span<const std::pair<std::string_view, RangeUpdate>> range_update_words() noexcept {
    return kRangeUpdates;
}

std::string_view table_of(const MappingKey& key) noexcept {
    const auto dot = key.path.find('.');
    return dot == std::string_view::npos ? std::string_view() : key.path.substr(0, dot);
}
std::string_view name_in_table(const MappingKey& key) noexcept {
    return key.path.substr(key.path.find('.') + 1);  // npos + 1 is 0
}

std::string expected_text(const MappingKey& key) {
    MappingConfig config;
    const auto text = [&key](auto* value) -> std::string {
        using Value = std::remove_pointer_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, bool>) return "true or false";
        if constexpr (std::is_same_v<Value, DepthUpdate>) return joined(kDepthUpdates);
        if constexpr (std::is_same_v<Value, RangeUpdate>) return joined(kRangeUpdates);
        const char* kind = std::is_integral_v<Value> ? "whole number" : "number";
        return fmt::format("a {} from {} to {}", kind, key.range.min, key.range.max);
    };
    return std::visit(text, key.value(config));
}

std::string value_text(const MappingKey& key, const MappingConfig& config) {
    MappingConfig copy = config;
    const auto text = [](const auto* value) -> std::string {
        using Value = std::remove_cv_t<std::remove_pointer_t<decltype(value)>>;
        if constexpr (std::is_same_v<Value, DepthUpdate>)
            return word_of(kDepthUpdates, *value);
        else if constexpr (std::is_same_v<Value, RangeUpdate>)
            return word_of(kRangeUpdates, *value);
        else
            return fmt::format("{}", *value);
    };
    return std::visit(text, key.value(copy));
}

}  // namespace octoskin
