#include "host/core/cross_check/fault_sum.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {
namespace {

/// Limit of the evidence against a fault that counts as credit for a sensor.
constexpr double kCreditMax = 14.0;
/// Subtracted from the evidence at each informative comparison.
constexpr double kDoubt = 0.15;
/// Weak evidence from one place (within 0.3 m) adds up to at most this, because it may come from one object.
/// Less than the evidence for a report.
constexpr double kPlaceM = 0.3;
constexpr double kPlaceMax = 5.0;
/// Upper limit of the accumulated evidence.
constexpr double kEvidenceMax = 40.0;
/// A comparison with this much evidence counts as for or against a fault; about the newest 64 are counted.
constexpr double kSaysMuch = 0.5;
constexpr float kForgotten = 1.0F - 1.0F / 64.0F;

}  // namespace

void FaultSum::add(double ratio, double expected, HostTime now) {
    if (ratio == 0.0) return;
    if (std::abs(ratio) >= kSaysMuch) {
        fors = kForgotten * fors + (ratio > 0.0 ? 1.0F : 0.0F);
        againsts = kForgotten * againsts + (ratio < 0.0 ? 1.0F : 0.0F);
    }
    if (for_it <= 0.0) since = now;
    for_it = std::clamp(for_it + ratio - kDoubt, -kCreditMax, kEvidenceMax);
    against_it = std::clamp(against_it - ratio - kDoubt, 0.0, kEvidenceMax);
    shows = std::clamp(shows + expected - kDoubt, 0.0, kEvidenceMax);
}

void FaultSum::add_weak(double ratio, double expected, const Beam& beam) {
    if (ratio > kDoubt) {
        const Eigen::Vector3f p_map = (beam.p_map_sensor + *beam.range_m * beam.direction_map).cast<float>();
        auto place = std::ranges::find_if(places, [&p_map](const Place& of) {
            return of.for_it > 0.0F && static_cast<double>((of.p_map - p_map).norm()) < kPlaceM;
        });
        if (place == places.end()) {
            place = std::ranges::min_element(places, {}, &Place::for_it);
            *place = Place{.p_map = p_map, .for_it = 0.0F};
        }
        ratio = std::min(ratio, kDoubt + kPlaceMax - static_cast<double>(place->for_it));
        place->for_it += static_cast<float>(ratio - kDoubt);
    }
    add(ratio, expected, beam.captured);
}

}  // namespace octoskin
