#include "common/lens/lens_distortion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace octoskin {
namespace {

constexpr double kRadiusMax = 4.0;
constexpr double kRadiusStep = 1e-3;
constexpr double kResidualMax = 1e-12;
constexpr int kNewtonStepsMax = 64;
constexpr int kHalvingsMax = 40;

double length(RaySlope slope) noexcept {
    return std::hypot(slope.x, slope.y);
}

RaySlope difference(RaySlope a, RaySlope b) noexcept {
    return {a.x - b.x, a.y - b.y};
}

/// The derivative of `distorted`. It is symmetric: the model is the gradient of a potential.
struct Derivative {
    double xx;
    double xy;
    double yy;
};

Derivative derivative(const LensDistortion& lens, RaySlope ray) noexcept {
    const double s = ray.x * ray.x + ray.y * ray.y;
    const double radial = 1.0 + s * (lens.k1 + s * (lens.k2 + s * lens.k3));
    const double per_s = lens.k1 + s * (2.0 * lens.k2 + s * 3.0 * lens.k3);
    return {radial + 2.0 * per_s * ray.x * ray.x + 2.0 * lens.p1 * ray.y + 6.0 * lens.p2 * ray.x,
            2.0 * per_s * ray.x * ray.y + 2.0 * lens.p1 * ray.x + 2.0 * lens.p2 * ray.y,
            radial + 2.0 * per_s * ray.y * ray.y + 6.0 * lens.p1 * ray.y + 2.0 * lens.p2 * ray.x};
}

/// A lower bound of the derivative's eigenvalues at this radius, in any direction. The eigenvalues of the
/// radial part are f and d(r f)/dr with f = 1 + k1 r^2 + k2 r^4 + k3 r^6. Those of the tangential part, 2
/// ((q.x) I + q x' + x q') with q = (p2, p1), are at least -6 |q| r.
double least_stretch(const LensDistortion& lens, double r) noexcept {
    const double s = r * r;
    const double outward = 1.0 + s * (3.0 * lens.k1 + s * (5.0 * lens.k2 + s * 7.0 * lens.k3));
    const double around = 1.0 + s * (lens.k1 + s * (lens.k2 + s * lens.k3));
    return std::min(outward, around) - 6.0 * r * std::hypot(lens.p1, lens.p2);
}

}  // namespace

std::string describe(const LensDistortion& lens) {
    char text[160];
    std::snprintf(text, sizeof(text), "k1 %g, k2 %g, p1 %g, p2 %g, k3 %g", lens.k1, lens.k2, lens.p1, lens.p2,
                  lens.k3);
    return text;
}

RaySlope distorted(const LensDistortion& lens, RaySlope ray) noexcept {
    const double s = ray.x * ray.x + ray.y * ray.y;
    const double radial = 1.0 + s * (lens.k1 + s * (lens.k2 + s * lens.k3));
    const double xy = 2.0 * ray.x * ray.y;
    return {ray.x * radial + lens.p1 * xy + lens.p2 * (s + 2.0 * ray.x * ray.x),
            ray.y * radial + lens.p1 * (s + 2.0 * ray.y * ray.y) + lens.p2 * xy};
}

/// A map whose derivative is symmetric and positive definite on a whole disc is one-to-one there (Gale and
/// Nikaido 1965, theorem 6). The smallest eigenvalue is checked from the centre outward.
LensInverse::LensInverse(const LensDistortion& lens) noexcept : lens_(lens), radius_(0.0) {
    for (int step = 1; step * kRadiusStep <= kRadiusMax; ++step) {
        if (!(least_stretch(lens, step * kRadiusStep) > 0.0)) return;
        radius_ = step * kRadiusStep;
    }
}

std::optional<RaySlope> LensInverse::ray_of(RaySlope picture) const noexcept {
    if (lens_.is_none()) return picture;
    RaySlope ray{};
    RaySlope off = difference(distorted(lens_, ray), picture);
    for (int step = 0; step < kNewtonStepsMax; ++step) {
        if (length(off) <= kResidualMax) return ray;
        const Derivative d = derivative(lens_, ray);
        const double determinant = d.xx * d.yy - d.xy * d.xy;  // positive within the radius
        RaySlope move{-(d.yy * off.x - d.xy * off.y) / determinant,
                      -(d.xx * off.y - d.xy * off.x) / determinant};
        // A step that leaves the disc or overshoots is halved until it does neither.
        bool is_nearer = false;
        for (int halving = 0; halving < kHalvingsMax && !is_nearer; ++halving) {
            const RaySlope next{ray.x + move.x, ray.y + move.y};
            const RaySlope next_off = difference(distorted(lens_, next), picture);
            is_nearer = length(next) <= radius_ && length(next_off) < length(off);
            if (is_nearer) {
                ray = next;
                off = next_off;
            }
            move = {0.5 * move.x, 0.5 * move.y};
        }
        if (!is_nearer) return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace octoskin
