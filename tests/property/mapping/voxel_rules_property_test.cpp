// The map does to many voxels at once what VoxelRules does to each: random evidence of all rules into a map
// and into voxels one by one, compared bit by bit.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "host/core/mapping/evidence.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/mapping/voxel_rules.hpp"

namespace octoskin {
namespace {

struct DatedVoxel {
    VoxelState state;
    std::int64_t seen_s = 0;
    SensorKind seen_by = SensorKind::none;
    bool is_seen = false;
    bool is_time_known = false;  ///< else it was seen at `seen_s` or before, and by what is not known
};

/// The rules, voxel by voxel, with nothing of the map's ways of storing.
class VoxelByVoxel {
  public:
    explicit VoxelByVoxel(const MapConfig& config) : config_(config), rules_(config) {}

    void advance_time(std::int64_t now_s) {
        now_s_ = now_s;
        if (config_.age.unknown_after_s == 0) return;
        std::erase_if(voxels_, [&](const auto& entry) {
            const DatedVoxel& voxel = entry.second;
            return voxel.is_seen && now_s_ - voxel.seen_s >= std::int64_t{config_.age.unknown_after_s};
        });
    }

    /// When anything was seen is not known any more: it is as old as this.
    void clear_times() {
        for (auto& [code, voxel] : voxels_) voxel = {voxel.state, now_s_, SensorKind::none, true, false};
    }

    void apply(const Evidence& evidence, const std::function<bool(VoxelKey)>& spares) {
        switch (evidence.rule) {
            case EvidenceRule::image:
                return for_each(
                    evidence, [&](DatedVoxel& voxel) { add_image(voxel, evidence.miss, true); },
                    [&](DatedVoxel& voxel, float term) { add_image(voxel, term, false); });
            case EvidenceRule::terms:
                return for_each(
                    evidence, [&](DatedVoxel& voxel) { add(voxel, evidence.miss, evidence.sensor); },
                    [&](DatedVoxel& voxel, float term) { add(voxel, term, evidence.sensor); });
            case EvidenceRule::counts:
                return count(evidence);
            case EvidenceRule::confirm:
                return confirm(evidence);
            case EvidenceRule::withdraw:
                return for_each(
                    evidence,
                    [&](DatedVoxel& voxel) {
                        if (!is_occupied(voxel) && voxel.state.hits > 0.0F) rules_.withdraw(voxel.state);
                    },
                    [](DatedVoxel&, float) {});
            case EvidenceRule::clear:
                return clear(evidence, spares);
            case EvidenceRule::weaken:
                return for_each(
                    evidence, [&](DatedVoxel& voxel) { weaken(voxel, evidence.miss); },
                    [](DatedVoxel&, float) {});
        }
    }

    [[nodiscard]] const std::map<MortonCode, DatedVoxel>& voxels() const { return voxels_; }

  private:
    template <class OnVoxel, class OnCell>
    void for_each(const Evidence& evidence, const OnVoxel& on_voxel, const OnCell& on_cell) {
        for (const BrickEvidence& brick : evidence.bricks) {
            for_each_cell(brick.voxels, [&](std::size_t cell) { on_voxel(voxels_[brick.first + cell]); });
            for (const CellTerm& cell : evidence.cells_of(brick))
                on_cell(voxels_[brick.first + cell.cell], cell.term);
        }
    }
    [[nodiscard]] bool is_occupied(const DatedVoxel& voxel) const {
        return rules_.is_occupied(voxel.state.log_odds);
    }
    [[nodiscard]] bool is_seen_by_camera(const DatedVoxel& voxel) const {
        return voxel.is_seen && voxel.seen_by == SensorKind::camera && now_s_ - voxel.seen_s <= 1;
    }
    void date(DatedVoxel& voxel, SensorKind sensor) const {
        voxel.seen_s = now_s_;
        voxel.seen_by = sensor;
        voxel.is_seen = true;
        voxel.is_time_known = true;
    }
    void add(DatedVoxel& voxel, float term, SensorKind sensor) const {
        if (!std::isfinite(term) || term == 0.0F) return;
        rules_.add(voxel.state, term);
        date(voxel, sensor);
    }
    void add_image(DatedVoxel& voxel, float term, bool is_miss) const {
        is_miss ? rules_.miss(voxel.state, term) : rules_.hit(voxel.state, term);
        date(voxel, SensorKind::camera);
    }
    [[nodiscard]] float share_of(const DatedVoxel& voxel, float weight, bool of_occupied) const {
        if (of_occupied && !is_occupied(voxel)) return 0.0F;
        return weight * rules_.probability(voxel.state);
    }
    [[nodiscard]] float sum_of(const Evidence& evidence, bool of_occupied) {
        float sum = 0.0F;
        for_each(
            evidence, [](DatedVoxel&) {},
            [&](DatedVoxel& voxel, float weight) { sum += share_of(voxel, weight, of_occupied); });
        return sum;
    }
    void count(const Evidence& evidence) {
        bool of_occupied = evidence.prefers_occupied;
        float sum = sum_of(evidence, of_occupied);
        if (sum == 0.0F && of_occupied) {
            of_occupied = false;
            sum = sum_of(evidence, of_occupied);
        }
        const auto hit = [&](DatedVoxel& voxel, float weight) {
            const float share = sum > 0.0F ? share_of(voxel, weight, of_occupied) / sum : 0.0F;
            if (share > 0.0F) rules_.count(voxel.state, evidence.hit * share, 0.0F);
        };
        for_each(
            evidence, [&](DatedVoxel& voxel) { rules_.count(voxel.state, 0.0F, evidence.miss); }, hit);
        const auto date_cap = [&](DatedVoxel& voxel, float weight) {
            const auto is_seen = [&] { return is_seen_by_camera(voxel); };
            if (rules_.dates_in_cap(voxel.state.log_odds, weight, is_seen)) date(voxel, SensorKind::range);
        };
        const auto date_passed = [&](DatedVoxel& voxel) {
            const auto is_seen = [&] { return is_seen_by_camera(voxel); };
            if (rules_.dates_passed(voxel.state.log_odds, is_seen)) date(voxel, SensorKind::range);
        };
        for_each(evidence, date_passed, date_cap);
    }
    void confirm(const Evidence& evidence) {
        bool is_explained = false;
        for_each(
            evidence, [](DatedVoxel&) {},
            [&](DatedVoxel& voxel, float weight) { is_explained |= weight > 0.0F && is_occupied(voxel); });
        if (is_explained) return;
        const auto mark = [&](DatedVoxel& voxel) {
            rules_.confirm(voxel.state, evidence.hit);
            date(voxel, SensorKind::range);
        };
        for_each(evidence, mark, [](DatedVoxel&, float) {});
    }
    void weaken(DatedVoxel& voxel, float term) const {
        rules_.weaken(voxel.state, term);
        const bool has_counts = voxel.state.hits > 0.0F || voxel.state.misses > 0.0F;
        if (std::isnan(voxel.state.log_odds) && !has_counts) voxel = {};
    }
    void clear(const Evidence& evidence, const std::function<bool(VoxelKey)>& spares) {
        for (const BrickEvidence& brick : evidence.bricks) {
            for_each_cell(brick.voxels, [&](std::size_t cell) {
                DatedVoxel& voxel = voxels_[brick.first + cell];
                if (!is_occupied(voxel) || is_seen_by_camera(voxel)) return;
                if (spares(key_of_morton(brick.first + cell))) return;
                rules_.clear(voxel.state);
                date(voxel, SensorKind::range);
            });
        }
    }

    MapConfig config_;
    VoxelRules rules_;
    std::int64_t now_s_ = 0;
    std::map<MortonCode, DatedVoxel> voxels_;
};

/// Evidence about a few bricks, so that all of it meets.
class RandomEvidence {
  public:
    explicit RandomEvidence(std::uint32_t seed) : random_(seed) {}

    [[nodiscard]] Evidence next(bool withdraws) {
        Evidence evidence;
        evidence.rule = static_cast<EvidenceRule>(below(7));
        if (evidence.rule == EvidenceRule::withdraw && !withdraws) evidence.rule = EvidenceRule::counts;
        const bool is_image = evidence.rule == EvidenceRule::image;
        const bool is_of_camera = is_image || (evidence.rule == EvidenceRule::weaken && below(2) == 0);
        evidence.sensor = is_of_camera ? SensorKind::camera : SensorKind::range;
        if (evidence.rule == EvidenceRule::terms && below(4) == 0)
            evidence.sensor = below(2) == 0 ? SensorKind::camera : SensorKind::none;
        evidence.prefers_occupied = below(2) == 0;
        const bool is_counts = evidence.rule == EvidenceRule::counts;
        evidence.miss = is_counts ? 0.37F : -0.4F;
        if (evidence.rule == EvidenceRule::weaken && below(2) == 0)
            evidence.miss = std::numeric_limits<float>::lowest();
        evidence.hit = is_counts ? 1.0F : 2.0F;
        // An image has each brick once, in order; others may come back to one.
        const std::size_t bricks = 1 + below(is_image ? kBricks : 6);
        for (std::size_t i = 0; i < bricks; ++i) add_brick(is_image ? i : below(kBricks), evidence);
        return evidence;
    }
    [[nodiscard]] std::size_t below(std::size_t limit) { return random_() % limit; }

  private:
    static constexpr std::size_t kBricks = 5;

    void add_brick(std::size_t number, Evidence& evidence) {
        const MortonCode first = brick_of({static_cast<std::uint16_t>(32768 + 8 * number), 32768, 32768});
        const auto begin = static_cast<std::uint32_t>(evidence.cells.size());
        BrickEvidence brick{first, {}, begin, begin};
        // Of rays no voxels; of images and cones at times all of a brick.
        if (evidence.rule != EvidenceRule::terms || below(3) == 0) {
            const std::size_t density = below(4);
            for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
                if (density == 3 || below(20) < density) put_in(brick.voxels, cell);
        }
        const std::size_t cells = density_of_cells();
        for (std::size_t cell = below(7); cell < kBrickVoxels && cells > 0; cell += 1 + below(cells)) {
            if (contains(brick.voxels, cell)) continue;
            evidence.cells.push_back({static_cast<std::uint16_t>(cell), term_of(evidence.rule)});
        }
        brick.cells_end = static_cast<std::uint32_t>(evidence.cells.size());
        evidence.bricks.push_back(brick);
    }
    [[nodiscard]] std::size_t density_of_cells() { return below(3) == 0 ? 0 : 200; }
    [[nodiscard]] float term_of(EvidenceRule rule) {
        if (rule == EvidenceRule::image) return below(5) == 0 ? -0.2F : 0.85F;
        if (rule == EvidenceRule::counts || rule == EvidenceRule::confirm)
            return below(6) == 0 ? 0.0F : 0.1F * static_cast<float>(1 + below(10));
        if (below(40) == 0) return below(2) == 0 ? 0.0F : std::nanf("");
        return below(2) == 0 ? -0.4F : 0.93F;
    }

    std::mt19937 random_;
};

std::uint32_t bits_of(float value) {
    return std::isnan(value) ? 0x7FC0'0000U : std::bit_cast<std::uint32_t>(value);
}

void expect_equal(const FusedMap& map, const VoxelByVoxel& expected) {
    std::size_t known = 0;
    const MapLayers& layers = map.layers();
    for (const auto& [code, voxel] : expected.voxels()) {
        const VoxelKey key = key_of_morton(code);
        const std::size_t cell = cell_of(key);
        const BrickView log_odds = map.brick(brick_of(key));
        ASSERT_EQ(bits_of(log_odds.at(cell)), bits_of(voxel.state.log_odds)) << code;
        known += std::isnan(voxel.state.log_odds) ? 0U : 1U;
        if (layers.counts.has(brick_of(key))) {
            ASSERT_EQ(bits_of(layers.counts.prior.find(brick_of(key)).at(cell)), bits_of(voxel.state.prior));
            ASSERT_EQ(bits_of(layers.counts.hits.find(brick_of(key)).at(cell)), bits_of(voxel.state.hits));
            ASSERT_EQ(bits_of(layers.counts.misses.find(brick_of(key)).at(cell)),
                      bits_of(voxel.state.misses));
        } else {
            ASSERT_EQ(voxel.state.hits + voxel.state.misses, 0.0F) << code;
        }
        const auto confirmation = map.confirmation(key);
        const bool is_dated = voxel.is_time_known && !std::isnan(voxel.state.log_odds);
        ASSERT_EQ(confirmation.has_value(), is_dated) << code;
        if (!is_dated) continue;
        ASSERT_EQ(confirmation->kind, voxel.seen_by) << code;
    }
    ASSERT_EQ(map.known_voxels(), known);
}

struct Way {
    std::uint32_t unknown_after_s;
    bool withdraws;
};

class VoxelRulesProperty : public testing::TestWithParam<Way> {};

TEST_P(VoxelRulesProperty, are_what_the_map_does_to_every_voxel) {
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
        SCOPED_TRACE(seed);
        MapConfig config = seed % 2 == 0 ? robust_mapping().map : MapConfig{};
        config.age.unknown_after_s = GetParam().unknown_after_s;
        FusedMap map(config);
        VoxelByVoxel expected(config);
        RandomEvidence random(seed);
        const std::function<bool(VoxelKey)> spares = [](VoxelKey key) { return (key.x + key.y) % 3 == 0; };
        std::int64_t now_s = 100;
        for (int step = 0; step < 150; ++step) {
            now_s += random.below(3) == 0 ? 1 : 0;
            map.advance_time(HostTime{now_s * 1'000'000'000});
            expected.advance_time(now_s);
            if (random.below(20) == 0) {
                map.clear_times();
                map.advance_time(HostTime{now_s * 1'000'000'000});
                expected.clear_times();
            }
            const Evidence evidence = random.next(GetParam().withdraws);
            map.apply(evidence, {.spares = &spares});
            expected.apply(evidence, spares);
            if (step % 5 != 0) continue;
            ASSERT_NO_FATAL_FAILURE(expect_equal(map, expected)) << step;
        }
        ASSERT_NO_FATAL_FAILURE(expect_equal(map, expected));
        EXPECT_GT(map.known_voxels(), 100U);
    }
}

// A voxel without counts that is known by its counts alone keeps its log-odds until its brick's counts are
// given back: with both, that is when the brick's other voxels expire, which voxel by voxel is not to be
// seen.
INSTANTIATE_TEST_SUITE_P(Ways, VoxelRulesProperty, testing::Values(Way{0, true}, Way{4, false}));

}  // namespace
}  // namespace octoskin
