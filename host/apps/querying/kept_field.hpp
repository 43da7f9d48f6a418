// A distance field that is kept from one question to the next, for as long as that pays.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/query/distance_field.hpp"

namespace octoskin {

/// Where distances are asked for.
struct AskedSpace {
    Eigen::AlignedBox3d axes;   ///< of all capsules in all postures, map frame
    double radius_max_m = 0.0;  ///< of a capsule, padding included
    double reach_m = 0.0;       ///< from the capsules' surface, above 0
    std::size_t postures = 0;

    void include(std::span<const PosedCapsule> capsules) {
        ++postures;
        for (const PosedCapsule& capsule : capsules) {
            axes.extend(capsule.p_a).extend(capsule.p_b);
            radius_max_m = std::max(radius_max_m, capsule.radius_m);
        }
    }
};

/// For one thread. Whether there is a field makes no difference to an answer, only to its time.
class KeptField {
  public:
    /// The field of this map, in which all that is asked for is told; null where searching costs less than
    /// bringing it up to date, or it would take more than kBricksMax bricks or than there is memory for. It
    /// is as it is until the next question.
    [[nodiscard]] const DistanceField* of(const FusedMap& map, const AskedSpace& asked);
    /// Before its space has been asked about that much, nothing is made.
    static constexpr std::size_t kPosturesMin = 20;
    /// Some 220 MiB if there were surfaces in all of them; a tenth of it in a room.
    static constexpr std::size_t kBricksMax = std::size_t{1} << 15U;

    [[nodiscard]] bool is_there() const noexcept { return field_.has_value(); }
    void drop() noexcept { field_.reset(); }

  private:
    [[nodiscard]] bool tells(const MapConfig& map, const AskedSpace& asked) const;
    [[nodiscard]] bool make(const MapConfig& map, const AskedSpace& asked);

    FieldExtent extent_;
    std::optional<DistanceField> field_;
};

}  // namespace octoskin
