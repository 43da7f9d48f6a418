// Access to single voxels of one brick after another, each as a VoxelState, for the writer of counts.
#pragma once

#include <cmath>
#include <cstddef>

#include "common/result.hpp"
#include "host/core/mapping/brick_editor.hpp"

namespace octoskin {

/// Reads all layers, and opens those that a change needs. In a brick without counts, the log-odds are the
/// priors.
class CountedBrick {
  public:
    explicit CountedBrick(BrickEditor& editor) noexcept : editor_(editor) { look_anew(); }

    void go_to(MortonCode brick) noexcept {
        if (has_brick_ && brick == first_) return;
        has_brick_ = true;
        first_ = brick;
        find();
    }

    [[nodiscard]] VoxelState at(std::size_t cell) const noexcept {
        return {log_odds_view_.at(cell), prior_view_.at(cell), hits_view_.at(cell), misses_view_.at(cell)};
    }
    [[nodiscard]] float log_odds(std::size_t cell) const noexcept { return log_odds_view_.at(cell); }
    [[nodiscard]] float hits(std::size_t cell) const noexcept { return hits_view_.at(cell); }

    /// Applies `rule` to a voxel. Returns the change of its log-odds, with unknown as 0, or the counter of
    /// the refusal.
    template <class Rule>
    [[nodiscard]] Result<float, MapRefusal> change(std::size_t cell, const Rule& rule) noexcept {
        if (const auto is_open = open_counts(); !is_open) return unexpected(is_open.error());
        const VoxelState before = at(cell);
        VoxelState voxel = before;
        rule(voxel);
        if (!are_same(voxel.prior, before.prior)) {
            if (const auto is_open = open_prior(); !is_open) return unexpected(is_open.error());
        }
        const bool is_changed = !are_same(voxel.log_odds, before.log_odds);
        if (is_changed) {
            if (const auto is_open = open_log_odds(); !is_open) return unexpected(is_open.error());
            editor_.set((*log_odds_)[cell], voxel.log_odds);
        }
        if (!are_same(voxel.prior, before.prior)) (*prior_)[cell] = voxel.prior;
        (*hits_)[cell] = voxel.hits;
        (*misses_)[cell] = voxel.misses;
        return is_changed ? voxel.log_odds - (std::isnan(before.log_odds) ? 0.0F : before.log_odds) : 0.0F;
    }

  private:
    [[nodiscard]] static bool are_same(float a, float b) noexcept {
        return a == b || (std::isnan(a) && std::isnan(b));
    }
    /// Call after a tree has got a new brick.
    void look_anew() noexcept;
    void find() noexcept;
    [[nodiscard]] Status<MapRefusal> open_counts() noexcept {
        return hits_ != nullptr && misses_ != nullptr ? Status<MapRefusal>(Done{}) : open_closed_counts();
    }
    [[nodiscard]] Status<MapRefusal> open_closed_counts() noexcept;
    [[nodiscard]] Status<MapRefusal> open_prior() noexcept;
    [[nodiscard]] Status<MapRefusal> open_log_odds() noexcept;

    BrickEditor& editor_;
    BrickTree::OwnBricks own_hits_{editor_.layers().counts.hits};
    BrickTree::OwnBricks own_misses_{editor_.layers().counts.misses};
    BrickTree::OwnBricks own_log_odds_{editor_.layers().log_odds};
    bool has_brick_ = false;
    MortonCode first_ = 0;
    BrickValues* hits_ = nullptr;
    BrickValues* misses_ = nullptr;
    BrickValues* log_odds_ = nullptr;
    BrickValues* prior_ = nullptr;
    BrickView hits_view_;
    BrickView misses_view_;
    BrickView log_odds_view_;
    BrickView prior_view_;
};

}  // namespace octoskin
