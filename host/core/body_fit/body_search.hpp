// Searches for capsules that cover points and take little space beyond the link.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/core/body_fit/capsule_search.hpp"
#include "host/core/body_fit/excess_field.hpp"

namespace octoskin {

/// A set of capsules that always covers all points up to kSlack_m. Each function takes a fixed number of
/// steps, so that the result is the same on each machine.
class BodySearch {
  public:
    /// Begins with one capsule. `points` is not empty; `field` must outlive this object.
    BodySearch(std::vector<Eigen::Vector3d> points, ExcessField& field);

    [[nodiscard]] const std::vector<PosedCapsule>& capsules() const noexcept { return capsules_; }
    void set_capsules(std::vector<PosedCapsule> capsules) { capsules_ = std::move(capsules); }
    /// Weighted voxels in the set.
    [[nodiscard]] double excess();

    /// Starts anew with one capsule around each of `count` groups of near points (k-means).
    void regroup(std::size_t count);
    /// Replaces one of the three capsules of largest excess by two: the split that saves most. False if none
    /// of them has points enough.
    bool split();
    /// Moves each capsule in turn: it needs to cover only the points that no other one covers.
    void refine(int sweeps, int rounds);
    /// Removes the capsule that is the `rank`-th cheapest to remove, and splits another one. Undone if that
    /// does not make the excess smaller.
    void exchange(std::size_t rank);

  private:
    struct Split {
        PosedCapsule first;
        PosedCapsule second;
        double saved = 0.0;
    };

    [[nodiscard]] std::vector<PosedCapsule> others(std::size_t index) const;
    [[nodiscard]] std::vector<Eigen::Vector3d> own_points(std::size_t index) const;
    [[nodiscard]] std::vector<std::size_t> largest() const;
    [[nodiscard]] std::optional<Split> best_split(std::size_t index);
    [[nodiscard]] Split split_into(std::span<const Eigen::Vector3d> low,
                                   std::span<const Eigen::Vector3d> high, std::vector<PosedCapsule> rest);
    void refit(std::size_t index, int rounds);
    void remove(std::size_t index);
    [[nodiscard]] std::size_t cheapest_to_remove(std::size_t rank);

    std::vector<Eigen::Vector3d> points_;
    ExcessField& field_;
    std::vector<PosedCapsule> capsules_;
};

}  // namespace octoskin
