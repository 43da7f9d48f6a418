// What a FusedMap does where range sensors that see a cone have counted.
#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

bool FusedMap::has_room_to_count(MortonCode brick) const noexcept {
    const std::size_t bytes_max = std::size_t{config_.memory_max_mib} << 20U;
    return 16 * (counts_.bytes_at_most() + counts_.bytes_of_new(brick)) <= 3 * bytes_max;
}

void FusedMap::set_known(float& voxel, float log_odds) noexcept {
    known_voxels_ += std::isnan(voxel) && !std::isnan(log_odds) ? 1U : 0U;
    voxel = log_odds;
}

/// The brick that the voxels are in that are counted one after the other. Most come in runs.
class FusedMap::CountedBrick {
  public:
    explicit CountedBrick(FusedMap& map) noexcept : map_(&map) { look_anew(); }

    /// Goes to the brick of a voxel.
    void go_to(VoxelKey key) noexcept {
        if (has_brick_ && are_of_one_brick(key, last_)) {
            last_ = key;
            return;
        }
        last_ = key;
        has_brick_ = true;
        first_ = brick_of(key);
        find();
    }

    [[nodiscard]] float probability(std::size_t cell) const noexcept {
        return map_->fusion_.probability(other_.at(cell), {hits_view_.at(cell), misses_view_.at(cell)});
    }

    /// Adds to a voxel's counts and fuses it; the answer is what that changes its log-odds by, or who counts
    /// the refusal.
    [[nodiscard]] Result<float, Refusal> add(std::size_t cell, float hits, float misses) noexcept {
        if (const auto is_open = open_counts(); !is_open) return unexpected(is_open.error());
        HitsAndMisses counts{(*hits_)[cell], (*misses_)[cell]};
        counts.add(hits, misses, map_->config_.counts.counts_max);
        if (const auto is_cleared = clear_other(cell, misses, counts.misses); !is_cleared)
            return unexpected(is_cleared.error());
        return put(cell, counts);
    }
    /// Of a voxel that is occupied from now on.
    [[nodiscard]] Result<float, Refusal> mark(std::size_t cell, float hits) noexcept {
        if (const auto is_open = open_counts(); !is_open) return unexpected(is_open.error());
        const float enough = std::max(hits, map_->fusion_.hits_that_mark(other_.at(cell)));
        return put(cell, {.hits = std::max((*hits_)[cell], enough), .misses = 0.0F});
    }

    [[nodiscard]] bool has_hits(std::size_t cell) const noexcept { return hits_view_.at(cell) > 0.0F; }
    /// Of a voxel that they do not mark.
    [[nodiscard]] Result<float, Refusal> forget_hits(std::size_t cell) noexcept {
        if (const auto is_open = open_counts(); !is_open) return unexpected(is_open.error());
        return put(cell, {.hits = 0.0F, .misses = (*misses_)[cell]});
    }

    /// Of a voxel that is free from now on, though it was occupied.
    [[nodiscard]] Result<float, Refusal> clear(std::size_t cell) noexcept {
        if (const auto is_open = open_counts(); !is_open) return unexpected(is_open.error());
        if (other_.at(cell) > 0.0F) {
            if (const auto is_set = set_other(cell, kUnknownLogOdds); !is_set)
                return unexpected(is_set.error());
        }
        const float enough = map_->fusion_.misses_that_free(other_.at(cell));
        return put(cell, {.hits = 0.0F, .misses = std::max((*misses_)[cell], enough)});
    }

  private:
    [[nodiscard]] Result<float, Refusal> put(std::size_t cell, const HitsAndMisses& counts) noexcept {
        const float before = fused_view_.at(cell);
        const float after = map_->fusion_.log_odds(other_.at(cell), counts, !std::isnan(before));
        if (after != before && !std::isnan(after)) {
            if (const auto is_open = open_fused(); !is_open) return unexpected(is_open.error());
            map_->set_known((*fused_)[cell], after);
        }
        (*hits_)[cell] = counts.hits;
        (*misses_)[cell] = counts.misses;
        return std::isnan(after) ? 0.0F : after - (std::isnan(before) ? 0.0F : before);
    }
    /// After a tree was given a brick.
    void look_anew() noexcept {
        own_hits_ = BrickTree::OwnBricks(map_->counts_.hits);
        own_misses_ = BrickTree::OwnBricks(map_->counts_.misses);
        own_fused_ = BrickTree::OwnBricks(map_->tree_);
    }
    void find() noexcept {
        hits_ = own_hits_.find(first_);
        misses_ = own_misses_.find(first_);
        fused_ = own_fused_.find(first_);
        const bool is_counted = hits_ != nullptr || map_->counts_.has(first_);
        hits_view_ = hits_ != nullptr ? BrickView{hits_} : none_if_unknown(map_->counts_.hits.find(first_));
        misses_view_ =
            misses_ != nullptr ? BrickView{misses_} : none_if_unknown(map_->counts_.misses.find(first_));
        fused_view_ = fused_ != nullptr ? BrickView{fused_} : map_->tree_.find(first_);
        other_ = is_counted ? map_->counts_.other.find(first_) : fused_view_;
    }
    static BrickView none_if_unknown(BrickView view) noexcept {
        return view.is_unknown() ? BrickView{nullptr, 0.0F} : view;
    }

    [[nodiscard]] Status<Refusal> open_counts() noexcept {
        if (hits_ != nullptr && misses_ != nullptr) return Done{};
        RangeCounts& counts = map_->counts_;
        const bool is_new = !counts.has(first_);
        if (is_new && !map_->has_room_to_count(first_)) return unexpected(&MapCounters::no_room);
        try {
            if (is_new) counts.begin(first_, map_->tree_.find(first_));
            (void)counts.misses.open(first_);
            (void)counts.hits.open(first_);
        } catch (const std::bad_alloc&) {
            return unexpected(&MapCounters::no_memory);
        }
        look_anew();
        find();
        return Done{};
    }
    /// What a miss takes of what is known otherwise.
    [[nodiscard]] Status<Refusal> clear_other(std::size_t cell, float misses, float misses_in_all) noexcept {
        const CountModel& model = map_->config_.counts;
        const float before = other_.at(cell);
        const bool clears =
            model.range_clears > 0.0F && misses > 0.0F && misses_in_all >= model.range_clears_from;
        if (!clears || !(before > 0.0F)) return Done{};
        return set_other(cell, std::max(before - model.range_clears, map_->config_.log_odds_min));
    }
    [[nodiscard]] Status<Refusal> set_other(std::size_t cell, float log_odds) noexcept {
        BrickValues* own = map_->counts_.other.own(first_);
        if (own == nullptr) {
            try {
                own = &map_->counts_.other.open(first_);
            } catch (const std::bad_alloc&) {
                return unexpected(&MapCounters::no_memory);
            }
            other_ = BrickView{own};
        }
        (*own)[cell] = log_odds;
        return Done{};
    }
    [[nodiscard]] Status<Refusal> open_fused() noexcept {
        if (fused_ != nullptr) return Done{};
        const auto is_open = map_->change(first_, [&] { fused_ = &map_->tree_.open(first_); });
        if (!is_open) return unexpected(is_open.error());
        own_fused_ = BrickTree::OwnBricks(map_->tree_);
        fused_view_ = BrickView{fused_};
        return Done{};
    }

    FusedMap* map_;
    BrickTree::OwnBricks own_hits_{map_->counts_.hits};
    BrickTree::OwnBricks own_misses_{map_->counts_.misses};
    BrickTree::OwnBricks own_fused_{map_->tree_};
    bool has_brick_ = false;
    VoxelKey last_;
    MortonCode first_ = 0;
    BrickValues* hits_ = nullptr;
    BrickValues* misses_ = nullptr;
    BrickValues* fused_ = nullptr;
    BrickView hits_view_;
    BrickView misses_view_;
    BrickView fused_view_;
    BrickView other_;
};

namespace {

/// False: there is no memory for it.
bool has_listed(std::vector<VoxelKey>& keys, VoxelKey key) noexcept {
    try {
        keys.push_back(key);
        return true;
    } catch (const std::bad_alloc&) {
        return false;
    }
}

ConeVoxels without(const ConeVoxels& cone, const std::vector<VoxelKey>& refused) {
    const auto is_refused = [&](VoxelKey key) { return std::ranges::find(refused, key) != refused.end(); };
    ConeVoxels taken = cone;
    std::erase_if(taken.passed, is_refused);
    std::erase_if(taken.cap, [&](const CapVoxel& voxel) { return is_refused(voxel.key); });
    return taken;
}

}  // namespace

void FusedMap::apply(const ConeVoxels& cone, const ConeModel& model, Blame blame,
                     std::vector<VoxelUpdate>* changes) {
    std::vector<VoxelKey> refused;
    bool names_refused = true;
    CountedBrick brick(*this);
    const auto add = [&](VoxelKey key, float hits, float misses) {
        brick.go_to(key);
        const auto change = brick.add(cell_of(key), hits, misses);
        ++(counters_.*(change ? &MapCounters::applied : change.error()));
        if (!change && !has_listed(refused, key)) names_refused = false;
        if (changes != nullptr && change && *change != 0.0F) changes->push_back({key, *change});
    };
    // A voxel comes once in a cap: its share is of what it was before, whoever got theirs first.
    const auto blame_of = [&](const CapVoxel& voxel) {
        if (blame == Blame::occupied && occupancy(voxel.key) != Occupancy::occupied) return 0.0F;
        brick.go_to(voxel.key);
        return voxel.weight * brick.probability(cell_of(voxel.key));
    };
    const auto blame_of_all = [&] {
        float sum = 0.0F;
        for (const CapVoxel& voxel : cone.cap) sum += blame_of(voxel);
        return sum;
    };
    float sum = blame_of_all();
    if (sum == 0.0F && blame == Blame::occupied) {
        blame = Blame::all;
        sum = blame_of_all();
    }
    if (sum > 0.0F) {
        for (const CapVoxel& voxel : cone.cap) {
            const float share = blame_of(voxel) / sum;
            if (share > 0.0F) add(voxel.key, model.hit_mass * share, 0.0F);
        }
    }
    for (const VoxelKey key : cone.passed) add(key, 0.0F, model.miss_mass);
    if (!confirmations_.has_begun() || !names_refused) return;
    if (refused.empty()) return confirm(cone);
    try {
        confirm(without(cone, refused));
    } catch (const std::bad_alloc&) {  // then nobody has confirmed the others either
    }
}

void FusedMap::mark(const ConeVoxels& cone, float hits, std::vector<VoxelUpdate>* changes) {
    const auto is_occupied = [this](const CapVoxel& voxel) {
        return voxel.weight > 0.0F && occupancy(voxel.key) == Occupancy::occupied;
    };
    if (std::ranges::any_of(cone.cap, is_occupied)) return;
    CountedBrick brick(*this);
    for (const VoxelKey key : cone.middle) {
        brick.go_to(key);
        take(key, brick.mark(cell_of(key), hits), changes);
    }
}

void FusedMap::forget_weak_hits(const ConeVoxels& cone, std::vector<VoxelUpdate>* changes) {
    CountedBrick brick(*this);
    for (const CapVoxel& voxel : cone.cap) {
        if (occupancy(voxel.key) == Occupancy::occupied) continue;
        brick.go_to(voxel.key);
        if (!brick.has_hits(cell_of(voxel.key))) continue;
        const auto change = brick.forget_hits(cell_of(voxel.key));
        ++(counters_.*(change ? &MapCounters::applied : change.error()));
        if (changes != nullptr && change && *change != 0.0F) changes->push_back({voxel.key, *change});
    }
}

void FusedMap::clear(const ConeVoxels& cone, const std::function<bool(VoxelKey)>& is_ranged,
                     std::vector<VoxelUpdate>* changes) {
    CountedBrick brick(*this);
    for (const VoxelKey key : cone.passed) {
        if (occupancy(key) != Occupancy::occupied) continue;
        if (is_seen_by_camera(confirmations_.find(brick_of(key)).at(cell_of(key))) || is_ranged(key))
            continue;
        brick.go_to(key);
        take(key, brick.clear(cell_of(key)), changes);
    }
}

bool FusedMap::is_seen_by_camera(std::uint16_t stamp) const noexcept {
    const auto last = confirmations_.told_by(stamp);
    return last && last->kind == SensorKind::camera && last->age_s <= 1;
}

/// What became of one voxel that was told to change.
void FusedMap::take(VoxelKey key, const Result<float, Refusal>& change, std::vector<VoxelUpdate>* changes) {
    ++(counters_.*(change ? &MapCounters::applied : change.error()));
    if (!change) return;
    if (changes != nullptr && *change != 0.0F) changes->push_back({key, *change});
    BrickMask voxel{};
    put_in(voxel, cell_of(key));
    if (confirmations_.has_begun()) confirm(brick_of(key), voxel, SensorKind::range);
}

void FusedMap::fuse(MortonCode brick) {
    const BrickView hits = counts_.hits.find(brick);
    const BrickView misses = counts_.misses.find(brick);
    const BrickView other = counts_.other.find(brick);
    const BrickView before = tree_.find(brick);
    BrickValues fused;
    bool is_any_known = false;
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        fused[cell] =
            fusion_.log_odds(other.at(cell), {hits.at(cell), misses.at(cell)}, !std::isnan(before.at(cell)));
        is_any_known = is_any_known || !std::isnan(fused[cell]);
    }
    if (!is_any_known) return;  // counted only: it needs no place
    BrickValues& values = tree_.open(brick);
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        if (!std::isnan(fused[cell])) set_known(values[cell], fused[cell]);
    }
}

void FusedMap::apply_beside_counts(std::span<const VoxelUpdate> run) noexcept {
    const MortonCode brick = brick_of(run.front().key);
    const BrickView hits = counts_.hits.find(brick);
    const BrickView misses = counts_.misses.find(brick);
    for (const VoxelUpdate& update : run) {
        if (!std::isfinite(update.log_odds) || update.log_odds == 0.0F) {
            ++(update.log_odds == 0.0F ? counters_.zero : counters_.not_finite);
            continue;
        }
        const std::size_t cell = cell_of(update.key);
        const auto done = change(brick, [&] {
            BrickValues& values = tree_.open(brick);
            BrickValues& other = counts_.other.open(brick);
            other[cell] = clamped(update.log_odds).added_to(other[cell]);
            set_known(values[cell], fusion_.log_odds(other[cell], {hits.at(cell), misses.at(cell)}, true));
        });
        ++(counters_.*(done ? &MapCounters::applied : done.error()));
    }
}

namespace {

/// Fewer are none: what is cleared must end at 0.
constexpr float kLeastCount = 0.01F;

bool has_any_among(const BrickView& counts, const BrickMask& voxels) {
    if (counts.values == nullptr) return counts.value > 0.0F;
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        if ((*counts.values)[cell] > 0.0F && contains(voxels, cell)) return true;
    }
    return false;
}

/// Takes a part of counts; what is left of few is none.
void take_share(BrickValues& counts, const BrickMask& voxels, float share) {
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        if (!contains(voxels, cell)) continue;
        counts[cell] *= 1.0F - share;
        if (counts[cell] < kLeastCount) counts[cell] = 0.0F;
    }
}

BrickMask marked_by(std::span<const CellTerm> hits) {
    BrickMask marked{};
    for (const CellTerm& hit : hits)
        if (hit.log_odds > 0.0F) put_in(marked, hit.cell);
    return marked;
}

}  // namespace

void FusedMap::apply_beside_counts(const DepthTerms& terms, const BrickTerms& brick) noexcept {
    const auto new_hits = terms.hits_of(brick);
    const BrickMask marked = marked_by(new_hits);
    const ClampedTerm miss = passed_term(terms.miss);
    const std::size_t passed = count_of(brick.passed);
    const BrickView before = counts_.other.find(brick.first);
    const CountModel& model = config_.counts;
    const bool clears =
        model.image_clears > 0.0F && has_any_among(counts_.hits.find(brick.first), brick.passed);
    const bool marks = model.image_marks > 0.0F && has_any_among(counts_.misses.find(brick.first), marked);
    Status<Refusal> done = Done{};
    if (clears || before.values != nullptr || !new_hits.empty() ||
        miss.added_to(before.value) != before.value) {
        done = change(brick.first, [&] {
            BrickValues& fused = tree_.open(brick.first);
            BrickValues& other = counts_.other.open(brick.first);
            if (clears) take_share(counts_.hits.open(brick.first), brick.passed, model.image_clears);
            if (marks) take_share(counts_.misses.open(brick.first), marked, model.image_marks);
            const BrickValues old = other;
            (void)add_to_voxels(other, brick.passed, miss);
            for (const CellTerm& hit : new_hits)
                other[hit.cell] = hit_term(hit.log_odds).added_to(other[hit.cell]);
            const BrickView hits = counts_.hits.find(brick.first);
            const BrickView misses = counts_.misses.find(brick.first);
            for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
                const bool is_changed = other[cell] != old[cell] && other[cell] == other[cell];
                if (!is_changed && !(clears && contains(brick.passed, cell)) &&
                    !(marks && contains(marked, cell)))
                    continue;
                set_known(fused[cell], fusion_.log_odds(other[cell], {hits.at(cell), misses.at(cell)}, true));
            }
        });
    }
    counters_.*(done ? &MapCounters::applied : done.error()) += passed + new_hits.size();
}

void FusedMap::forget_counts_of(std::span<const VoxelUpdate> voxels) {
    if (counts_.empty()) return;
    for_each_run(voxels, [this](MortonCode brick, const BrickMask& mask) {
        if (counts_.has(brick)) counts_.forget(brick, mask);
    });
}

void FusedMap::forget_counts() noexcept {
    counts_ = {};
    if (config_.age.unknown_after_s > 0) confirmations_ = {};
}

}  // namespace octoskin
