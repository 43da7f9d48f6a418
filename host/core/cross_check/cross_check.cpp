#include "host/core/cross_check/cross_check.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace octoskin {
namespace {

/// Differences within this many standard deviations of camera and range together, plus a tolerance for pose
/// errors, are no contradiction.
constexpr double kSigmas = 3.0;
constexpr double kPoseErrorM = 0.03;
/// The arm moves by centimetres in this time.
constexpr Nanoseconds kSameTime{150'000'000};
/// A sensor that has moved or turned by this much gives new evidence.
constexpr double kMovedM = 0.015;
constexpr double kTurnedCos = 0.99939;  // 2 degrees
/// For a sensor of unknown optics: its cone has 27 degrees, and what it reports usually lies in the inner
/// half.
constexpr double kInnerHalfAngle = 6.75 * std::numbers::pi / 180.0;
constexpr std::size_t kRays = 19;

/// The axis, six rays half-way to the rim, twelve at the rim.
std::array<Eigen::Vector3d, kRays> cone_about(const Eigen::Vector3d& axis, double half_angle) {
    const Eigen::Vector3d right = axis.unitOrthogonal();
    const Eigen::Vector3d up = axis.cross(right);
    std::array<Eigen::Vector3d, kRays> rays;
    std::size_t next = 0;
    rays[next++] = axis;
    for (const auto& [count, part] : {std::pair{6, 0.5}, std::pair{12, 1.0}}) {
        for (int i = 0; i < count; ++i) {
            const double turn = 2.0 * std::numbers::pi * i / count;
            const double off = part * half_angle;
            rays[next++] =
                std::cos(off) * axis + std::sin(off) * (std::cos(turn) * right + std::sin(turn) * up);
        }
    }
    return rays;
}

bool has_moved(const Beam& beam, const Beam& before) {
    return (beam.p_map_sensor - before.p_map_sensor).norm() >= kMovedM ||
           beam.direction_map.dot(before.direction_map) <= kTurnedCos;
}

/// Contradictions over a shorter time, or at one place only, may come from an object that the camera does not
/// show.
constexpr Nanoseconds kContradictsForMin{8'000'000'000};
constexpr double kElsewhereM = 0.12;
/// If the camera may misplace a point by more than this, depth edges are not where the image shows them.
constexpr double kMisplacedM = 0.06;
/// The camera's filter removes about half of its noise.
constexpr double kFiltered = 0.5;
/// Number of fitting ranges from which a sensor supports the camera.
constexpr std::uint64_t kAgreeingFrom = 10;

std::vector<std::size_t> sensors_of_nodes(const HostRig& rig) {
    std::vector<std::size_t> counts;
    for (const HostNode& node : rig.nodes) counts.push_back(node.sensors.size());
    return counts;
}

}  // namespace

CrossCheck::CrossCheck(const HostRig& rig, const CrossCheckConfig& config, std::size_t camera)
    : config_(config),
      camera_(rig.cameras.at(camera).intrinsics),
      ray_slope_max_(LensInverse(camera_.lens).radius()),
      judge_(sensors_of_nodes(rig), rig.joint_names().size()) {
    assert(0.0 < config.contradicted_sound && config.contradicted_sound < config.contradicted_faulty &&
           config.contradicted_faulty < 1.0);
    const PredictorConfig predictor{.camera_sigma_m =
                                        config.camera_sigma_m * (config.is_filtered ? kFiltered : 1.0)};
    for (const HostNode& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            places_.try_emplace(SensorId{node.node_id, static_cast<std::uint8_t>(i)}, sensors_.size());
            Sensor& sensor = sensors_.emplace_back();
            for (const HostZone& zone : node.sensors[i].zones) {
                sensor.predictors.emplace_back(zone.direction_sensor, zone.optics, predictor);
                sensor.optics.push_back(zone.optics);
            }
        }
    }
    next_ = sensors_.size();
}

void CrossCheck::on_beam(const Beam& beam, const Eigen::Isometry3d& T_map_sensor,
                         const JointTwists& twists_map) {
    auto& newest = sensors_[index_of(beam.source.node_id, beam.source.sensor)].newest;
    std::rotate(newest.begin(), newest.end() - 1, newest.end());
    newest.front() = Placed{beam, T_map_sensor, twists_map};
    compare_next();
}

void CrossCheck::on_depth(SeenImages& images, const Eigen::Isometry3d& T_map_camera, HostTime captured) {
    const std::size_t pixels = std::size_t{camera_.width} * camera_.height;
    assert(images.world.depth_m.size() == pixels && images.everything.depth_m.size() == pixels &&
           images.certainty.size() == pixels);
    if (next_ < sensors_.size()) judge();
    std::swap(images_, images);
    T_map_camera_ = T_map_camera;
    // Not always the newest: for a sensor with its own period, every third image would compare the same.
    const std::size_t wanted = image_count_++ % 3;
    for (Sensor& sensor : sensors_) {
        sensor.waiting.reset();
        std::size_t age = wanted;
        while (age > 0 && !sensor.newest[age]) --age;
        const auto& placed = sensor.newest[age];
        if (placed && std::chrono::abs(captured - placed->beam.captured) <= kSameTime &&
            !(sensor.counted && !has_moved(placed->beam, *sensor.counted)))
            sensor.waiting = placed;
        sensor.newest = {};
    }
    next_ = 0;
}

void CrossCheck::settle() {
    while (next_ < sensors_.size()) compare_next();
}

CameraView CrossCheck::view() const {
    return CameraView({images_.everything, images_.world, images_.certainty}, camera_, T_map_camera_,
                      ray_slope_max_);
}

void CrossCheck::go_to_waiting() {
    while (next_ < sensors_.size() && !sensors_[next_].waiting) ++next_;
}

void CrossCheck::compare_next() {
    go_to_waiting();
    if (next_ < sensors_.size()) {
        Sensor& sensor = sensors_[next_];
        const auto placed = std::exchange(sensor.waiting, std::nullopt);
        const Beam& beam = placed->beam;
        const std::size_t zone = beam.source.zone;
        const CameraView view = this->view();
        const Finding finding = compare(beam, sensor.optics[zone], view);
        bool says_something = finding != Finding::nothing;
        if (says_something) count(sensor, beam, finding);
        if (beam.range_m) {
            compared_.push_back({static_cast<std::uint16_t>(next_), beam,
                                 sensor.predictors[zone].predict(view, placed->T_map_sensor),
                                 octoskin::placed(view.T_camera_map(), placed->twists_map)});
            says_something |= compared_.back().predictions.mounted.range_m.has_value();
        }
        if (says_something) sensor.counted = beam;
        go_to_waiting();
        if (next_ == sensors_.size()) judge();
    }
}

/// Both tests must be without doubt. The test for large errors has none while its log-likelihood ratio is at
/// most 0.
std::optional<SensorDoubt> CrossCheck::doubt_of(const Sensor& sensor,
                                                const SensorJudge::SensorFinding& verdict,
                                                std::optional<SensorDoubt> against_naming) const {
    if (sensor.evidence.contradicts()) return std::nullopt;
    if (sensor.found_far_off) return against_naming.value_or(SensorDoubt::ambiguous);
    if (verdict.doubt) return verdict.doubt;
    const bool is_unreported = sensor.evidence.log_likelihood_ratio > 0.0;
    return is_unreported ? std::optional(SensorDoubt::ambiguous) : std::nullopt;
}

/// Called once for each image.
void CrossCheck::judge() {
    next_ = sensors_.size();
    judge_.judge(compared_);
    compared_.clear();
    contradicting_ = 0;
    agreeing_ = 0;
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        const SensorJudge::SensorFinding& verdict = judge_.verdict(static_cast<std::uint16_t>(i));
        SensorEvidence& evidence = sensors_[i].evidence;
        // A finding counts for the other sensors at once.
        judge_.set_far_off(static_cast<std::uint16_t>(i), sensors_[i].found_far_off);
        const auto against_naming =
            judge_.against_naming(static_cast<std::uint16_t>(i),
                                  T_map_camera_.inverse() * sensors_[i].p_contradicted_map, kMisplacedM);
        evidence.is_far_off =
            sensors_[i].found_far_off && (evidence.is_far_off || !against_naming) && !judge_.pose().fault();
        evidence.fault = verdict.fault;
        evidence.doubt = doubt_of(sensors_[i], verdict, against_naming);
        evidence.not_excluded = verdict.not_excluded;
        evidence.compared = verdict.compared;
        evidence.fitted = verdict.agreed;
        evidence.exchanged_with = verdict.exchanged_with;
        evidence.evidence = verdict.evidence;
        sensors_[i].contradicted = evidence.contradicts();
        contradicting_ += evidence.contradicts() ? 1U : 0U;
        agreeing_ +=
            !evidence.contradicts() && std::max(evidence.fitted, evidence.agreed) >= kAgreeingFrom ? 1U : 0U;
    }
}

bool CrossCheck::is_to_be_refused(std::uint8_t node_id, std::uint8_t sensor) const {
    return contradicting_ <= agreeing_ && sensors_[index_of(node_id, sensor)].contradicted;
}

CrossCheck::Finding CrossCheck::compare(const Beam& beam, const BeamOptics& optics,
                                        const CameraView& view) const {
    const double bound_m = kSigmas * (config_.camera_sigma_m + beam.sigma_m) + kPoseErrorM;
    const double range_m = beam.range_m.value_or(beam.clear_limit_m);
    const auto cone =
        cone_about(beam.direction_map, optics.is_cone() ? optics.half_angle_rad : kInnerHalfAngle);
    const auto all_of_cone = [&cone](const auto& holds) { return std::ranges::all_of(cone, holds); };
    const auto look_at_end = [&](const Eigen::Vector3d& ray) {
        const auto look = view.look_at(beam.p_map_sensor + range_m * ray);
        return look && look->is_certain() ? look : std::nullopt;
    };
    const bool sees_through = beam.range_m && all_of_cone([&](const Eigen::Vector3d& ray) {
                                  const auto look = look_at_end(ray);
                                  return look && look->is_clear() && look->behind_m > bound_m;
                              });
    if (sees_through) return Finding::in_free_space;
    const bool sees_it = beam.range_m && all_of_cone([&](const Eigen::Vector3d& ray) {
                             const auto look = look_at_end(ray);
                             return look && !look->is_robot && std::abs(look->behind_m) <= bound_m;
                         });
    if (sees_it) return Finding::agrees;
    const bool is_stopped = all_of_cone([&](const Eigen::Vector3d& ray) {
        return view.is_stopped(beam.p_map_sensor, ray, range_m, bound_m);
    });
    return is_stopped ? Finding::behind_surface : Finding::nothing;
}

/// Wald's sequential test, repeated: each completed test flags the sensor or clears it. A test flags a sensor
/// that is contradicted in at most `contradicted_sound` of its comparisons, independently, with a probability
/// of at most false_alarm / (1 - missed) (Wald 1945). Contradictions that flag a sensor must span some time
/// and more than one place.
void CrossCheck::count(Sensor& sensor, const Beam& beam, Finding finding) const {
    SensorEvidence& evidence = sensor.evidence;
    const double sound = config_.contradicted_sound;
    const double faulty = config_.contradicted_faulty;
    const bool agrees = finding == Finding::agrees;
    evidence.agreed += agrees ? 1 : 0;
    evidence.in_free_space += finding == Finding::in_free_space ? 1 : 0;
    evidence.behind_surface += finding == Finding::behind_surface ? 1 : 0;
    evidence.log_likelihood_ratio +=
        agrees ? std::log((1.0 - faulty) / (1.0 - sound)) : std::log(faulty / sound);
    const double faulty_from = std::log((1.0 - config_.missed) / config_.false_alarm);
    evidence.log_likelihood_ratio = std::min(evidence.log_likelihood_ratio, faulty_from);
    if (!agrees) {
        const Eigen::Vector3d p_map =
            beam.p_map_sensor + beam.range_m.value_or(beam.clear_limit_m) * beam.direction_map;
        sensor.p_contradicted_map = p_map;
        if (!sensor.first_contradiction) sensor.first_contradiction = {beam.captured, p_map};
        const Contradiction& first = *sensor.first_contradiction;
        sensor.contradicts_elsewhere |= (p_map - first.p_map).norm() > kElsewhereM;
        const bool is_faulty = evidence.log_likelihood_ratio >= faulty_from && sensor.contradicts_elsewhere &&
                               beam.captured - first.captured >= kContradictsForMin;
        if (!is_faulty) return;
        sensor.found_far_off = true;
    } else {
        const bool is_sound =
            evidence.log_likelihood_ratio <= std::log(config_.missed / (1.0 - config_.false_alarm));
        if (!is_sound) return;
        sensor.found_far_off = false;
    }
    evidence.log_likelihood_ratio = 0.0;
    sensor.first_contradiction.reset();
    sensor.contradicts_elsewhere = false;
}

void CrossCheck::forget_beams() {
    compared_.clear();
    next_ = sensors_.size();
    for (Sensor& sensor : sensors_) {
        sensor.newest = {};
        sensor.waiting.reset();
    }
}

std::size_t CrossCheck::index_of(std::uint8_t node_id, std::uint8_t sensor) const {
    const auto found = places_.find({node_id, sensor});
    assert(found != places_.end());
    return found->second;
}

const SensorEvidence& CrossCheck::evidence(std::uint8_t node_id, std::uint8_t sensor) const {
    return sensors_[index_of(node_id, sensor)].evidence;
}

}  // namespace octoskin
