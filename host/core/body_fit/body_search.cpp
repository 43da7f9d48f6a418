#include "host/core/body_fit/body_search.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace octoskin {
namespace {

constexpr int kRoundsOfSplit = 6;
constexpr double kRounding_m = 1e-9;
constexpr double kFar = 1e9;

using Points = std::vector<Eigen::Vector3d>;

bool covers(const PosedCapsule& capsule, const Eigen::Vector3d& point) {
    return distance_to_surface(capsule, point) <= kSlack_m + kRounding_m;
}

/// Sets the radius to the smallest one that covers `points`.
void set_radius(std::span<const Eigen::Vector3d> points, PosedCapsule& capsule) {
    double lacking_m = -kFar;
    for (const Eigen::Vector3d& point : points)
        lacking_m = std::max(lacking_m, distance_to_surface(capsule, point) - kSlack_m);
    if (!points.empty()) capsule.radius_m = std::max(kRadiusMin_m, capsule.radius_m + lacking_m);
}

/// The index of the centre that is nearest to the point.
std::size_t nearest_of(const Points& centres, const Eigen::Vector3d& point) {
    const auto nearest = std::ranges::min_element(
        centres, {}, [&](const Eigen::Vector3d& centre) { return (point - centre).squaredNorm(); });
    return static_cast<std::size_t>(nearest - centres.begin());
}

/// Points each as far as possible from those before it.
Points far_apart(const Points& points, std::size_t count) {
    Points centres{points.front()};
    std::vector<double> nearest2(points.size(), kFar);
    while (centres.size() < count) {
        for (std::size_t i = 0; i < points.size(); ++i)
            nearest2[i] = std::min(nearest2[i], (points[i] - centres.back()).squaredNorm());
        const auto farthest = std::ranges::max_element(nearest2);
        centres.push_back(points[static_cast<std::size_t>(farthest - nearest2.begin())]);
    }
    return centres;
}

std::vector<Points> groups_of(const Points& points, std::size_t count) {
    constexpr int kSteps = 12;
    Points centres = far_apart(points, count);
    std::vector<Points> groups;
    for (int step = 0; step < kSteps; ++step) {
        groups.assign(count, {});
        for (const Eigen::Vector3d& point : points) groups[nearest_of(centres, point)].push_back(point);
        for (std::size_t i = 0; i < count; ++i) {
            if (groups[i].empty()) continue;
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (const Eigen::Vector3d& point : groups[i]) sum += point;
            centres[i] = sum / static_cast<double>(groups[i].size());
        }
    }
    std::erase_if(groups, [](const Points& group) { return group.empty(); });
    return groups;
}

}  // namespace

BodySearch::BodySearch(std::vector<Eigen::Vector3d> points, ExcessField& field)
    : points_(std::move(points)), field_(field) {
    constexpr int kRounds = 20;
    field_.take_out({});
    capsules_.push_back(capsule_around(extreme_points(points_), field_, kRounds).capsule);
    set_radius(points_, capsules_.front());
}

double BodySearch::excess() {
    double sum = 0.0;
    for (std::size_t i = 0; i < capsules_.size(); ++i) {
        field_.take_out(std::span(capsules_).first(i));
        sum += field_.excess(capsules_[i]);
    }
    return sum;
}

void BodySearch::regroup(std::size_t count) {
    capsules_.clear();
    for (const Points& group : groups_of(points_, count)) {
        field_.take_out(capsules_);
        capsules_.push_back(capsule_around(extreme_points(group), field_, kRoundsOfSplit).capsule);
        set_radius(group, capsules_.back());
    }
}

std::vector<std::size_t> BodySearch::largest() const {
    constexpr std::size_t kCount = 3;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < capsules_.size(); ++i) {
        field_.take_out(others(i));
        order.emplace_back(-field_.excess(capsules_[i]), i);
    }
    std::ranges::sort(order);
    order.resize(std::min(order.size(), kCount));
    std::vector<std::size_t> indices;
    for (const auto& [excess, index] : order) indices.push_back(index);
    return indices;
}

bool BodySearch::split() {
    std::optional<Split> best;
    std::size_t best_index = 0;
    for (const std::size_t index : largest()) {
        const auto found = best_split(index);
        if (!found || (best && found->saved <= best->saved)) continue;
        best = found;
        best_index = index;
    }
    if (!best) return false;
    capsules_[best_index] = best->first;
    capsules_.push_back(best->second);
    return true;
}

std::optional<BodySearch::Split> BodySearch::best_split(std::size_t index) {
    constexpr std::array kShares{0.25, 0.5, 0.75};
    const Points own = own_points(index);
    if (own.size() < 4) return std::nullopt;
    const auto rest = others(index);
    field_.take_out(rest);
    const double before = field_.excess(capsules_[index]);
    const Eigen::Matrix3d axes = main_axes(own);
    std::optional<Split> best;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d normal = axes.col(axis);
        const auto height = [&](const Eigen::Vector3d& point) { return normal.dot(point); };
        const auto [lowest, highest] = std::ranges::minmax_element(own, {}, height);
        for (const double share : kShares) {
            const double at_m = (1.0 - share) * height(*lowest) + share * height(*highest);
            Points low;
            Points high;
            for (const Eigen::Vector3d& point : own) (height(point) > at_m ? high : low).push_back(point);
            if (low.size() < 2 || high.size() < 2) continue;
            Split split = split_into(low, high, rest);
            split.saved += before;
            if (!best || split.saved > best->saved) best = split;
        }
    }
    return best;
}

/// `saved` is without what the capsule before the split took. The field is as it was: without `rest`.
BodySearch::Split BodySearch::split_into(std::span<const Eigen::Vector3d> low,
                                         std::span<const Eigen::Vector3d> high,
                                         std::vector<PosedCapsule> rest) {
    Split split{capsule_around(extreme_points(low), field_, kRoundsOfSplit).capsule,
                capsule_around(extreme_points(high), field_, kRoundsOfSplit).capsule, 0.0};
    set_radius(low, split.first);
    set_radius(high, split.second);
    split.saved -= field_.excess(split.first);
    rest.push_back(split.first);
    field_.take_out(rest);
    split.saved -= field_.excess(split.second);
    rest.pop_back();
    field_.take_out(rest);
    return split;
}

void BodySearch::refine(int sweeps, int rounds) {
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (std::size_t i = 0; i < capsules_.size(); ++i) refit(i, rounds);
}

void BodySearch::refit(std::size_t index, int rounds) {
    const Points own = own_points(index);
    if (own.empty()) return;
    field_.take_out(others(index));
    PosedCapsule next = improved(capsules_[index], extreme_points(own), field_, rounds).capsule;
    set_radius(own, next);
    if (field_.excess(next) < field_.excess(capsules_[index])) capsules_[index] = next;
}

void BodySearch::exchange(std::size_t rank) {
    if (capsules_.size() < 2) return;
    const auto before = capsules_;
    const double excess_before = excess();
    remove(cheapest_to_remove(rank));
    refine(2, 12);
    split();
    refine(3, 16);
    if (!(excess() < excess_before)) capsules_ = before;
}

std::size_t BodySearch::cheapest_to_remove(std::size_t rank) {
    std::vector<std::pair<double, std::size_t>> order;
    const auto before = capsules_;
    for (std::size_t i = 0; i < before.size(); ++i) {
        remove(i);
        order.emplace_back(excess(), i);
        capsules_ = before;
    }
    std::ranges::sort(order);
    return order[std::min(rank, order.size() - 1)].second;
}

/// Each of its own points enlarges the nearest other capsule.
void BodySearch::remove(std::size_t index) {
    const Points own = own_points(index);
    capsules_.erase(capsules_.begin() + static_cast<std::ptrdiff_t>(index));
    for (const Eigen::Vector3d& point : own) {
        const auto nearest = std::ranges::min_element(
            capsules_, {}, [&](const PosedCapsule& capsule) { return distance_to_surface(capsule, point); });
        nearest->radius_m += std::max(0.0, distance_to_surface(*nearest, point) - kSlack_m);
    }
}

std::vector<PosedCapsule> BodySearch::others(std::size_t index) const {
    std::vector<PosedCapsule> rest = capsules_;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(index));
    return rest;
}

/// The points that no other capsule covers.
std::vector<Eigen::Vector3d> BodySearch::own_points(std::size_t index) const {
    Points own;
    for (const Eigen::Vector3d& point : points_) {
        bool is_shared = false;
        for (std::size_t i = 0; i < capsules_.size() && !is_shared; ++i)
            is_shared = i != index && covers(capsules_[i], point);
        if (!is_shared) own.push_back(point);
    }
    return own;
}

}  // namespace octoskin
