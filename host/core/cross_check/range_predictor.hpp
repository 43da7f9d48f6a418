// Predicts a sensor's range from the camera's image: for the sensor as mounted in the rig, and turned.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "host/core/cross_check/camera_view.hpp"
#include "host/core/rig/beam_optics.hpp"

namespace octoskin {

/// The surface that a sensor measures, map frame: a point, and its normal towards the camera.
struct SeenSurface {
    Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal_map = Eigen::Vector3d::UnitZ();
};

struct RangePrediction {
    std::optional<double> range_m;       ///< range of the surface that the camera sees there
    double sigma_m = 0.0;                ///< its standard deviation, without the sensor's own
    double hidden_until_m = 0.0;         ///< nearer than this, anything may be present
    double clear_m = 0.0;                ///< the camera sees free space from there to here
    double depth_per_m = 1.0;            ///< of RayReach, for most of it
    bool is_from_behind = false;         ///< of RayReach, for any of it
    std::optional<SeenSurface> surface;  ///< the surface of most of it, if that is one plane
};

/// Number of turned directions, evenly distributed about the zone's axis.
inline constexpr std::size_t kTurns = 8;
inline constexpr double kTurnDeg = 10.0;

/// Where a ray of a sensor meets a plane that the camera sees, in camera coordinates.
struct PlaneHit {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< of the ray
    SeenPlane plane;
    double share = 1.0;  ///< share of the measured signal
};

struct RangePredictions {
    std::vector<PlaneHit> hits;                  ///< hits that form the range as mounted, if there is one
    RangePrediction mounted;                     ///< as mounted in the rig
    std::array<RangePrediction, kTurns> turned;  ///< turned about the sensor's position by kTurnDeg
};

struct PredictorConfig {
    double camera_sigma_m = 0.03;   ///< standard deviation of an image's value
    double turn_sigma_rad = 0.012;  ///< tolerated angular error of a mount
    double range_max_m = 2.5;       ///< no prediction beyond this
};

/// Predicts for one zone of one sensor.
class RangePredictor {
  public:
    RangePredictor(const Eigen::Vector3d& direction_sensor, const BeamOptics& optics,
                   const PredictorConfig& config);

    /// Predicts from the sensor's pose. Follows 13 rays for an ideal ray, about 170 for the VL53L1X's cone: 5
    /// and 50 us.
    [[nodiscard]] RangePredictions predict(const CameraView& view,
                                           const Eigen::Isometry3d& T_map_sensor) const;

  private:
    struct Weighed {
        std::size_t ray = 0;
        double weight = 0.0;
    };
    using Bundle = std::vector<Weighed>;
    struct Echo {
        std::size_t ray = 0;
        double range_m = 0.0;
        double signal = 0.0;
        double variance = 0.0;
        double depth_per_m = 0.0;
        bool is_from_behind = false;
    };
    struct FollowedRay {
        RayReach reach;
        std::optional<PlaneHit> hit;
    };
    using Followed = std::vector<FollowedRay>;
    /// In ascending order of range; the peak is a contiguous part of them.
    struct Echoes {
        std::array<Echo, 128> all;
        std::size_t count = 0;
        std::size_t peak_begin = 0;
        std::size_t peak_end = 0;
    };

    [[nodiscard]] Followed follow(const CameraView& view, const Eigen::Isometry3d& T_map_sensor) const;
    [[nodiscard]] static double spread_of(const Bundle& bundle, const Followed& rays);
    [[nodiscard]] RangePrediction prediction_of(const Bundle& bundle, const Followed& rays,
                                                Echoes& echoes) const;
    [[nodiscard]] static std::optional<SeenSurface> surface_of(const std::vector<PlaneHit>& hits,
                                                               const CameraView& view);
    [[nodiscard]] static std::vector<PlaneHit> hits_of(const Echoes& echoes, const Followed& rays);
    [[nodiscard]] bool find_peak(Echoes& echoes) const;

    PredictorConfig config_;
    bool is_cone_ = false;
    std::vector<Eigen::Vector3d> rays_sensor_;
    Bundle mounted_;
    std::array<Bundle, kTurns> turned_;
};

}  // namespace octoskin
