// A distance field that is kept between queries for as long as it saves time.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/query/distance_field.hpp"

namespace octoskin {

/// The space of a query's distances.
struct AskedSpace {
    Eigen::AlignedBox3d axes;   ///< axes of all capsules in all postures, map frame
    double radius_max_m = 0.0;  ///< radius of a capsule, padding included
    double reach_m = 0.0;       ///< from the capsules' surface; greater than 0
    std::size_t postures = 0;

    void include(std::span<const PosedCapsule> capsules) {
        ++postures;
        for (const PosedCapsule& capsule : capsules) {
            axes.extend(capsule.p_a).extend(capsule.p_b);
            radius_max_m = std::max(radius_max_m, capsule.radius_m);
        }
    }
};

/// For one thread. The field changes only the time of an answer, never the answer.
class KeptField {
  public:
    /// The field of this map for the requested space. Null if a search costs less than updating the field, if
    /// it would need more than kBricksMax bricks, or if memory is insufficient. Valid until the next query.
    [[nodiscard]] const DistanceField* of(const FusedMap& map, const AskedSpace& asked);
    /// Minimum of postures in this space before a field is made.
    static constexpr std::size_t kPosturesMin = 20;
    /// About 220 MiB if all of them contained surfaces; a tenth of that in a room.
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
