#include "hw/sim/camera/cone_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hw/rigfile/zone.hpp"

namespace octoskin::sim {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kPeakWidth_m = 0.15;
constexpr double kPeakShare = 0.3;
constexpr double kNearest_m = 0.01;

/// The share of a Gaussian blur centred at `place` that falls between two places on a line.
double caught(double from, double to, double place, double blur) {
    const double scale = 1.0 / (blur * std::numbers::sqrt2);
    return 0.5 * (std::erf((to - place) * scale) - std::erf((from - place) * scale));
}

/// For each angle: the share of the light on the array that falls on the zone.
std::vector<double> shares(const std::vector<double>& angles_rad, rig::ZoneSpan zone, double blur_rad) {
    const double edge = rig::kArrayHalfWidth_rad;
    const double outermost =
        edge + 4.0 * blur_rad;  // beyond it all light falls on the edge, and it is negligible
    std::vector<double> shares;
    shares.reserve(angles_rad.size());
    for (const double angle : angles_rad) {
        const double place = std::clamp(angle, -outermost, outermost);
        shares.push_back(caught(zone.min_rad, zone.max_rad, place, blur_rad) /
                         caught(-edge, edge, place, blur_rad));
    }
    return shares;
}

}  // namespace

ConeView::ConeView(const rig::Cone& cone) : blur_rad_(cone.blur_deg * kRadPerDeg) {
    const double half_angle = cone.half_angle_deg * kRadPerDeg;
    const double sigma = cone.sigma_deg * kRadPerDeg;
    const double step = 2.0 * half_angle / cone.sub_rays;
    for (std::uint8_t i = 0; i < cone.sub_rays; ++i) angles_rad_.push_back((i + 0.5) * step - half_angle);
    double sum = 0.0;
    for (std::size_t row = 0; row < angles_rad_.size(); ++row) {
        for (std::size_t column = 0; column < angles_rad_.size(); ++column) {
            const Eigen::Vector3d ray(std::tan(angles_rad_[column]), std::tan(angles_rad_[row]), 1.0);
            const double off_axis = std::acos(1.0 / ray.norm());
            if (off_axis > half_angle) continue;
            places_.push_back({column, row});
            directions_.push_back(ray.normalized());
            weights_.push_back(std::exp(-0.5 * off_axis * off_axis / (sigma * sigma)));
            sum += weights_.back();
        }
    }
    for (double& weight : weights_) weight /= sum;
}

std::vector<double> ConeView::weights(const Roi& zone) const {
    const std::vector<double> across = shares(angles_rad_, rig::zone_span_x(zone), blur_rad_);
    const std::vector<double> down = shares(angles_rad_, rig::zone_span_y(zone), blur_rad_);
    std::vector<double> weights = weights_;
    for (std::size_t i = 0; i < weights.size(); ++i)
        weights[i] *= across[places_[i].column] * down[places_[i].row];
    return weights;
}

double echo_signal(double weight, double reflectivity, double cos_incidence, double range_m) {
    const double distance = std::max(range_m, kNearest_m);
    return weight * reflectivity * cos_incidence / (distance * distance);
}

std::optional<Echo> nearest_peak(std::vector<Echo>& echoes) {
    std::sort(echoes.begin(), echoes.end(),
              [](const Echo& a, const Echo& b) { return a.range_m < b.range_m; });
    struct Stretch {  ///< an interval of range that begins at an echo
        double signal = 0.0;
        double moment = 0.0;
    };
    std::vector<Stretch> stretches(echoes.size());
    double strongest = 0.0;
    for (std::size_t i = 0; i < echoes.size(); ++i) {
        Stretch& stretch = stretches[i];
        const double end_m = echoes[i].range_m + kPeakWidth_m;
        for (std::size_t j = i; j < echoes.size() && echoes[j].range_m <= end_m; ++j) {
            stretch.signal += echoes[j].signal;
            stretch.moment += echoes[j].signal * echoes[j].range_m;
        }
        strongest = std::max(strongest, stretch.signal);
    }
    if (!(strongest > 0.0)) return std::nullopt;
    const auto peak = std::find_if(stretches.begin(), stretches.end(), [&](const Stretch& stretch) {
        return stretch.signal >= kPeakShare * strongest;
    });
    return Echo{peak->moment / peak->signal, peak->signal};
}

}  // namespace octoskin::sim
