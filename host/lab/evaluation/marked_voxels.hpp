// The voxels that a map marks as occupied, against the surfaces: the base of both precisions.
#pragma once

#include <cstdint>
#include <optional>

#include "host/core/mapping/voxel_rules.hpp"
#include "host/lab/evaluation/truth_config.hpp"

namespace octoskin::evaluation {

struct MarkedVoxels {
    std::uint64_t all = 0;  ///< those inside a solid left out, as in the next two
    std::uint64_t on_surface = 0;
    std::uint64_t near_surface = 0;  ///< on a surface, or one voxel beside it

    /// Counts a voxel if it is marked.
    void add(Occupancy state, const SurfaceVoxel& truth) noexcept {
        if (truth.is_interior || state != Occupancy::occupied) return;
        all += 1;
        on_surface += truth.is_surface ? 1U : 0U;
        near_surface += truth.is_near_surface ? 1U : 0U;
    }
    /// Shares of `all`; empty without any.
    [[nodiscard]] std::optional<double> precision() const noexcept { return share(on_surface); }
    [[nodiscard]] std::optional<double> precision_tolerant() const noexcept { return share(near_surface); }

  private:
    [[nodiscard]] std::optional<double> share(std::uint64_t part) const noexcept {
        if (all == 0) return std::nullopt;
        return static_cast<double>(part) / static_cast<double>(all);
    }
};

}  // namespace octoskin::evaluation
