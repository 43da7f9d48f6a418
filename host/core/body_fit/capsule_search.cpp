#include "host/core/body_fit/capsule_search.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/core/body_fit/golden_turn.hpp"

namespace octoskin {
namespace {

constexpr int kDirections = 24;
constexpr std::size_t kTried = 3;  ///< of the directions

/// Evenly spread over the half sphere (Fibonacci lattice).
std::vector<Eigen::Vector3d> directions(int count) {
    std::vector<Eigen::Vector3d> all;
    GoldenTurn turn;
    for (int i = 0; i < count; ++i, turn.advance()) {
        const double z = (i + 0.5) / count;
        const double across = std::sqrt(1.0 - z * z);
        all.emplace_back(across * turn.cosine(), across * turn.sine(), z);
    }
    return all;
}

double radius_over(const PosedCapsule& capsule, std::span<const Eigen::Vector3d> points) {
    const Eigen::Vector3d axis = capsule.p_b - capsule.p_a;
    const double length2 = axis.squaredNorm();
    const double inverse = length2 > 0.0 ? 1.0 / length2 : 0.0;
    double farthest2 = 0.0;
    for (const Eigen::Vector3d& point : points) {
        const Eigen::Vector3d from_a = point - capsule.p_a;
        const double along = std::clamp(from_a.dot(axis) * inverse, 0.0, 1.0);
        farthest2 = std::max(farthest2, (from_a - along * axis).squaredNorm());
    }
    return std::max(kRadiusMin_m, std::sqrt(farthest2) - kSlack_m);
}

ScoredCapsule scored(PosedCapsule capsule, std::span<const Eigen::Vector3d> points,
                     const ExcessField& field) {
    capsule.radius_m = radius_over(capsule, points);
    return {capsule, field.excess(capsule)};
}

/// The smallest circle's centre in the plane across u, nearly (Badoiu, Clarkson 2003).
Eigen::Vector3d circle_centre(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& u) {
    constexpr int kSteps = 30;
    Eigen::Vector3d centre = points[0] - points[0].dot(u) * u;
    for (int step = 0; step < kSteps; ++step) {
        Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
        double farthest2 = -1.0;
        for (const Eigen::Vector3d& point : points) {
            Eigen::Vector3d apart = point - centre;
            apart -= apart.dot(u) * u;
            if (apart.squaredNorm() > farthest2) {
                farthest2 = apart.squaredNorm();
                farthest = apart;
            }
        }
        centre += farthest / (step + 2.0);
    }
    return centre;
}

/// The shortest capsule along u whose wall touches the points.
PosedCapsule along(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& u) {
    PosedCapsule capsule;
    const Eigen::Vector3d centre = circle_centre(points, u);
    double radius2 = 0.0;
    for (const Eigen::Vector3d& point : points) {
        const Eigen::Vector3d apart = point - centre;
        radius2 = std::max(radius2, (apart - apart.dot(u) * u).squaredNorm());
    }
    double from = 1e9;
    double to = -1e9;
    for (const Eigen::Vector3d& point : points) {
        const Eigen::Vector3d apart = point - centre;
        const double t = apart.dot(u);
        const double round = std::sqrt(std::max(0.0, radius2 - (apart - t * u).squaredNorm()));
        from = std::min(from, t + round);
        to = std::max(to, t - round);
    }
    if (from > to) from = to = 0.5 * (from + to);
    capsule.p_a = centre + from * u;
    capsule.p_b = centre + to * u;
    capsule.radius_m = std::sqrt(radius2);
    return capsule;
}

double volume_of(const PosedCapsule& capsule) {
    const double r = capsule.radius_m;
    return std::numbers::pi * r * r * ((capsule.p_b - capsule.p_a).norm() + 4.0 / 3.0 * r);
}

/// Moves of the two ends, in a frame along the axis.
std::array<std::array<Eigen::Vector3d, 2>, 20> moves_of(const PosedCapsule& capsule) {
    Eigen::Vector3d u = capsule.p_b - capsule.p_a;
    u = u.squaredNorm() > 1e-12 ? Eigen::Vector3d(u.normalized()) : Eigen::Vector3d::UnitX();
    const Eigen::Vector3d v = u.unitOrthogonal();
    const Eigen::Vector3d w = u.cross(v);
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    return {{{u, zero},  {-u, zero}, {zero, u},  {zero, -u}, {v, zero},  {-v, zero}, {w, zero},
             {-w, zero}, {zero, v},  {zero, -v}, {zero, w},  {zero, -w}, {v, v},     {-v, -v},
             {w, w},     {-w, -w},   {u, u},     {-u, -u},   {u, -u},    {-u, u}}};
}

}  // namespace

Eigen::Matrix3d main_axes(std::span<const Eigen::Vector3d> points) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : points) mean += point;
    mean /= static_cast<double>(points.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& point : points) spread += (point - mean) * (point - mean).transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.compute(spread);  // with square roots only: the same on each processor
    return solver.eigenvectors();
}

std::vector<Eigen::Vector3d> extreme_points(std::span<const Eigen::Vector3d> points) {
    constexpr int kCount = 120;
    if (points.size() <= 2 * kCount) return {points.begin(), points.end()};
    std::vector<std::size_t> chosen;
    for (const Eigen::Vector3d& direction : directions(kCount)) {
        std::size_t low = 0;
        std::size_t high = 0;
        double lowest = 1e9;
        double highest = -1e9;
        for (std::size_t k = 0; k < points.size(); ++k) {
            const double t = direction.dot(points[k]);
            if (t < lowest) {
                lowest = t;
                low = k;
            }
            if (t > highest) {
                highest = t;
                high = k;
            }
        }
        chosen.push_back(low);
        chosen.push_back(high);
    }
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    std::vector<Eigen::Vector3d> extremes;
    for (const std::size_t k : chosen) extremes.push_back(points[k]);
    return extremes;
}

ScoredCapsule improved(const PosedCapsule& start, std::span<const Eigen::Vector3d> points,
                       const ExcessField& field, int rounds) {
    ScoredCapsule best = scored(start, points, field);
    double step_m = std::clamp(0.25 * best.capsule.radius_m, 0.002, 0.02);
    std::size_t last = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto moves = moves_of(best.capsule);
        bool is_better = false;
        for (std::size_t k = 0; k < moves.size(); ++k) {
            const std::size_t i = (last + k) % moves.size();
            PosedCapsule moved = best.capsule;
            moved.p_a += step_m * moves[i][0];
            moved.p_b += step_m * moves[i][1];
            const ScoredCapsule next = scored(moved, points, field);
            if (!(next.excess < best.excess)) continue;
            best = next;
            last = i;
            is_better = true;
            break;
        }
        if (!is_better) step_m *= 0.5;
        if (step_m < 0.0004) break;
    }
    return best;
}

ScoredCapsule capsule_around(std::span<const Eigen::Vector3d> points, const ExcessField& field, int rounds) {
    std::vector<PosedCapsule> candidates;
    const Eigen::Matrix3d axes = main_axes(points);
    for (int i = 0; i < 3; ++i) candidates.push_back(along(points, axes.col(i)));
    for (const Eigen::Vector3d& u : directions(kDirections)) candidates.push_back(along(points, u));
    std::ranges::stable_sort(candidates, {}, volume_of);
    ScoredCapsule best = improved(candidates[0], points, field, rounds);
    for (std::size_t i = 1; i < kTried; ++i) {
        const ScoredCapsule other = improved(candidates[i], points, field, rounds);
        if (other.excess < best.excess) best = other;
    }
    return best;
}

}  // namespace octoskin
