#include "host/core/witness/sensor_witness.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace octoskin {
namespace {

/// So many deviations of camera and range together, and this much for poses that are a little off, are no
/// contradiction.
constexpr double kSigmas = 3.0;
constexpr double kPoseErrorM = 0.03;
/// The arm moves by centimetres meanwhile.
constexpr Nanoseconds kSameTime{150'000'000};
/// Where a sensor has moved or turned by so much since, it says something new.
constexpr double kMovedM = 0.015;
constexpr double kTurnedCos = 0.99939;  // 2 degrees
/// The sensor sees 27 degrees; what it reports lies in the inner half as a rule.
constexpr double kInnerHalfAngle = 6.75 * std::numbers::pi / 180.0;
/// Along a ray. A surface is crossed where the camera's depth and the ray's own come within this of each
/// other.
constexpr double kWalkBeginM = 0.1;
constexpr double kWalkStepM = 0.03;
constexpr double kCrossingM = 0.12;

constexpr std::size_t kRays = 19;

/// The axis, six rays half-way to the rim, twelve at the rim.
std::array<Eigen::Vector3d, kRays> cone_about(const Eigen::Vector3d& axis) {
    const Eigen::Vector3d right = axis.unitOrthogonal();
    const Eigen::Vector3d up = axis.cross(right);
    std::array<Eigen::Vector3d, kRays> rays;
    std::size_t next = 0;
    rays[next++] = axis;
    for (const auto& [count, part] : {std::pair{6, 0.5}, std::pair{12, 1.0}}) {
        for (int i = 0; i < count; ++i) {
            const double turn = 2.0 * std::numbers::pi * i / count;
            const double off = part * kInnerHalfAngle;
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

}  // namespace

std::string describe(const SensorEvidence& evidence) {
    return "contradicts the camera (" + std::to_string(evidence.in_free_space) +
           " ranges end where it sees through, " + std::to_string(evidence.behind_surface) +
           " behind a surface that it sees, " + std::to_string(evidence.agreed) +
           " agree): is it swapped with another at the harness, stuck, or its pose in the rig not the true "
           "one?";
}

/// An image, asked about points of the map.
class SensorWitness::View {
  public:
    View(const DepthImage& image, const CameraIntrinsics& camera, const Eigen::Isometry3d& T_map_camera,
         double ray_slope_max)
        : image_(image),
          camera_(camera),
          T_camera_map_(T_map_camera.inverse()),
          ray_slope_max_(ray_slope_max) {}

    /// By how much what the camera sees in the point's direction lies behind the point, along the optical
    /// axis; empty if it does not look there or has no value.
    [[nodiscard]] std::optional<double> behind_m(const Eigen::Vector3d& p_map) const {
        const Eigen::Vector3d p_camera = T_camera_map_ * p_map;
        if (!(p_camera.z() > 0.0)) return std::nullopt;
        const auto pixel = pixel_of({p_camera.x() / p_camera.z(), p_camera.y() / p_camera.z()});
        if (!pixel) return std::nullopt;
        const auto depth_m = static_cast<double>(image_.depth_m[*pixel]);
        if (!std::isfinite(depth_m)) return std::nullopt;
        return depth_m - p_camera.z();
    }

    /// Whether the ray goes through a surface that the camera sees, and on behind it by over `bound_m`. It
    /// must be seen on both sides of the surface: a ray that passes behind an object's outline is not stopped
    /// by it.
    [[nodiscard]] bool is_stopped(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double range_m, double bound_m) const {
        std::optional<double> before;
        bool has_crossed = false;
        for (double along_m = kWalkBeginM; along_m <= range_m; along_m += kWalkStepM) {
            const auto now = behind_m(origin + along_m * direction);
            const bool is_continuous = before && now && std::abs(*now - *before) <= kCrossingM;
            if (!is_continuous || *now >= 0.0) {
                has_crossed = false;
            } else if (*before >= 0.0) {
                has_crossed = true;
            }
            if (has_crossed && *now < -bound_m) return true;
            before = now;
        }
        return false;
    }

  private:
    /// The pixel that the ray goes through, row-major.
    [[nodiscard]] std::optional<std::size_t> pixel_of(RaySlope ray) const {
        if (std::hypot(ray.x, ray.y) > ray_slope_max_) return std::nullopt;
        const RaySlope picture = distorted(camera_.lens, ray);
        const double u = std::floor(picture.x * camera_.fx + camera_.cx);
        const double v = std::floor(picture.y * camera_.fy + camera_.cy);
        if (!(u >= 0.0 && u < camera_.width && v >= 0.0 && v < camera_.height)) return std::nullopt;
        return static_cast<std::size_t>(v) * camera_.width + static_cast<std::size_t>(u);
    }

    const DepthImage& image_;
    const CameraIntrinsics& camera_;
    Eigen::Isometry3d T_camera_map_;
    double ray_slope_max_;
};

SensorWitness::SensorWitness(const HostRig& rig, const WitnessConfig& config)
    : config_(config),
      camera_(rig.camera.value().intrinsics),
      ray_slope_max_(LensInverse(camera_.lens).radius()) {
    assert(0.0 < config.contradicted_sound && config.contradicted_sound < config.contradicted_faulty &&
           config.contradicted_faulty < 1.0);
    for (const HostNode& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i)
            sensors_.try_emplace({node.node_id, static_cast<std::uint8_t>(i)});
    }
}

void SensorWitness::on_beam(const Beam& beam) {
    const auto found = sensors_.find({beam.source.node_id, beam.source.sensor});
    assert(found != sensors_.end());
    found->second.newest = beam;
}

void SensorWitness::on_depth(const WitnessImages& images, const Eigen::Isometry3d& T_map_camera,
                             HostTime captured) {
    assert(images.world.depth_m.size() == std::size_t{camera_.width} * camera_.height);
    assert(images.everything.depth_m.size() == images.world.depth_m.size());
    const View everything(images.everything, camera_, T_map_camera, ray_slope_max_);
    const View world(images.world, camera_, T_map_camera, ray_slope_max_);
    for (auto& [source, sensor] : sensors_) {
        const auto beam = std::exchange(sensor.newest, std::nullopt);
        if (!beam || std::chrono::abs(captured - beam->captured) > kSameTime) continue;
        if (sensor.counted && !has_moved(*beam, *sensor.counted)) continue;
        const Finding finding = compare(*beam, everything, world);
        if (finding == Finding::nothing) continue;
        sensor.counted = beam;
        count(sensor, finding);
    }
}

SensorWitness::Finding SensorWitness::compare(const Beam& beam, const View& everything,
                                              const View& world) const {
    const double bound_m = kSigmas * (config_.camera_sigma_m + beam.sigma_m) + kPoseErrorM;
    const double range_m = beam.range_m.value_or(beam.clear_limit_m);
    const auto cone = cone_about(beam.direction_map);
    const auto all_of_cone = [&cone](const auto& holds) { return std::ranges::all_of(cone, holds); };
    const bool sees_through = beam.range_m && all_of_cone([&](const Eigen::Vector3d& ray) {
                                  const auto behind_m =
                                      everything.behind_m(beam.p_map_sensor + range_m * ray);
                                  return behind_m && *behind_m > bound_m;
                              });
    if (sees_through) return Finding::in_free_space;
    const bool sees_it = beam.range_m && all_of_cone([&](const Eigen::Vector3d& ray) {
                             const auto behind_m = world.behind_m(beam.p_map_sensor + range_m * ray);
                             return behind_m && std::abs(*behind_m) <= bound_m;
                         });
    if (sees_it) return Finding::agrees;
    const bool is_stopped = all_of_cone([&](const Eigen::Vector3d& ray) {
        return world.is_stopped(beam.p_map_sensor, ray, range_m, bound_m);
    });
    return is_stopped ? Finding::behind_surface : Finding::nothing;
}

/// Wald's sequential test, again and again: each one that ends flags the sensor or clears it. One test flags
/// a sensor that is contradicted in at most `contradicted_sound` of its comparisons, independently, with a
/// probability of at most false_alarm / (1 - missed) (Wald 1945).
void SensorWitness::count(Sensor& sensor, Finding finding) const {
    SensorEvidence& evidence = sensor.evidence;
    const double sound = config_.contradicted_sound;
    const double faulty = config_.contradicted_faulty;
    const bool agrees = finding == Finding::agrees;
    evidence.agreed += agrees ? 1 : 0;
    evidence.in_free_space += finding == Finding::in_free_space ? 1 : 0;
    evidence.behind_surface += finding == Finding::behind_surface ? 1 : 0;
    evidence.log_likelihood_ratio +=
        agrees ? std::log((1.0 - faulty) / (1.0 - sound)) : std::log(faulty / sound);
    const bool is_faulty =
        evidence.log_likelihood_ratio >= std::log((1.0 - config_.missed) / config_.false_alarm);
    const bool is_sound =
        evidence.log_likelihood_ratio <= std::log(config_.missed / (1.0 - config_.false_alarm));
    if (!is_faulty && !is_sound) return;
    evidence.contradicts = is_faulty;
    evidence.log_likelihood_ratio = 0.0;
}

void SensorWitness::forget_beams() {
    for (auto& [source, sensor] : sensors_) sensor.newest.reset();
}

const SensorEvidence& SensorWitness::evidence(std::uint8_t node_id, std::uint8_t sensor) const {
    const auto found = sensors_.find({node_id, sensor});
    assert(found != sensors_.end());
    return found->second.evidence;
}

}  // namespace octoskin
