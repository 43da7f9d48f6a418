#include "host/core/mapping/end_memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "host/core/depth/denoised_row.hpp"

namespace octoskin {
namespace {

/// Where a pixel ends.
struct Place {
    VoxelKey key;
    float depth_m = 0.0F;
};
using Places = std::vector<std::optional<Place>>;

/// A voxel at (x, 0, 0) in the middle of the map; its depth is x / 10.
std::optional<Place> at(int x) {
    return Place{{static_cast<std::uint16_t>(32768 + x), 32768, 32768}, 0.1F * static_cast<float>(x)};
}
MortonCode code_at(int x) {
    return morton_of(at(x)->key);
}

ProjectedImage image_of(const Places& places) {
    ProjectedImage image;
    image.width = static_cast<std::uint32_t>(places.size());
    image.height = 1;
    for (const auto& place : places) {
        image.key_xy.push_back(place ? place->key.x | std::uint32_t{place->key.y} << 16U : 0U);
        image.key_z.push_back(place ? place->key.z : ProjectedImage::kNoKey);
        image.reach_m.push_back(place ? place->depth_m : -1.0F);
    }
    return image;
}

/// A hit for each end, and `passed` as misses.
Evidence terms_of(const Places& places, const std::vector<VoxelKey>& passed = {}) {
    std::set<MortonCode> hits;
    for (const auto& place : places)
        if (place) hits.insert(morton_of(place->key));
    std::vector<VoxelUpdate> updates;
    for (const MortonCode code : hits) updates.push_back({key_of_morton(code), 0.8F});
    for (const VoxelKey key : passed)
        if (!hits.contains(morton_of(key))) updates.push_back({key, -0.4F});
    Evidence terms;
    terms.miss = -0.4F;
    terms.take_image(std::move(updates));
    return terms;
}

std::vector<MortonCode> found_by(EndMemory& memory, const Places& now,
                                 const std::vector<std::uint8_t>& changes,
                                 const std::vector<VoxelKey>& passed = {}) {
    Evidence retracted;
    retracted.rule = EvidenceRule::terms;
    retracted.bricks.resize(3);  // is replaced
    memory.find(image_of(now), changes, terms_of(now, passed), retracted);
    EXPECT_EQ(retracted.rule, EvidenceRule::weaken);
    EXPECT_EQ(retracted.sensor, SensorKind::camera);
    EXPECT_TRUE(retracted.cells.empty());
    EXPECT_TRUE(std::ranges::is_sorted(retracted.bricks, std::ranges::less_equal{}, &BrickEvidence::first));
    std::vector<MortonCode> codes;
    for (const BrickEvidence& brick : retracted.bricks) {
        EXPECT_NE(brick.voxels, BrickMask{});
        for_each_cell(brick.voxels, [&](std::size_t cell) { codes.push_back(brick.first + cell); });
    }
    return codes;
}

void keep(EndMemory& memory, const Places& now, std::vector<std::uint8_t> changes = {}) {
    changes.resize(now.size(), 0);
    memory.keep(image_of(now), changes);
}

/// With no surface that has changed.
std::vector<MortonCode> found_by(EndMemory& memory, const Places& now) {
    return found_by(memory, now, std::vector<std::uint8_t>(now.size(), 0));
}

using Codes = std::vector<MortonCode>;

TEST(EndMemory, retracts_the_voxel_that_a_pixel_leaves_for_another) {
    EndMemory memory;
    keep(memory, {at(20), at(21)});
    EXPECT_EQ(found_by(memory, {at(20), at(21)}), Codes{});
    EXPECT_EQ(found_by(memory, {at(19), at(21)}), Codes{code_at(20)}) << "nearer";
    EXPECT_EQ(found_by(memory, {at(23), at(21)}), Codes{code_at(20)}) << "farther";
    EXPECT_EQ(found_by(memory, {at(19), at(22)}), (Codes{code_at(20), code_at(21)}));
}

TEST(EndMemory, retracts_nothing_without_a_memory) {
    EndMemory memory;
    EXPECT_EQ(found_by(memory, {at(20)}), Codes{});
    keep(memory, {at(21)});
    memory.forget();
    EXPECT_TRUE(memory.ends().empty());
    EXPECT_EQ(found_by(memory, {at(20)}), Codes{});
}

TEST(EndMemory, spares_a_voxel_in_which_another_pixel_ends_now) {
    EndMemory memory;
    keep(memory, {at(20), at(22)});
    EXPECT_EQ(found_by(memory, {at(21), at(20)}), Codes{code_at(22)});
    EXPECT_EQ(found_by(memory, {at(22), at(20)}), Codes{}) << "they change places";
}

// It has been passed, too: a miss is no reason to spare it.
TEST(EndMemory, retracts_a_voxel_that_rays_pass_now) {
    EndMemory memory;
    keep(memory, {at(20)});
    EXPECT_EQ(found_by(memory, {at(24)}, {0}, {at(19)->key, at(20)->key, at(21)->key}), Codes{code_at(20)});
}

TEST(EndMemory, spares_a_voxel_of_a_pixel_that_has_no_value_now) {
    EndMemory memory;
    keep(memory, {at(20), at(20)});
    EXPECT_EQ(found_by(memory, {at(21), std::nullopt}), Codes{});
    EXPECT_EQ(found_by(memory, {std::nullopt, std::nullopt}), Codes{});
    // It still states what it did while others come and go.
    keep(memory, {at(21), std::nullopt});
    EXPECT_EQ(found_by(memory, {at(22), std::nullopt}), Codes{code_at(21)});
    keep(memory, {at(20), std::nullopt});
    EXPECT_EQ(found_by(memory, {at(22), std::nullopt}), Codes{});
    EXPECT_EQ(found_by(memory, {at(22), at(23)}), Codes{code_at(20)});
}

TEST(EndMemory, says_nothing_of_a_voxel_that_a_new_nearer_surface_hides) {
    EndMemory memory;
    keep(memory, {at(20), at(30)});
    EXPECT_EQ(found_by(memory, {at(10), at(30)}, {kChangeConfirmed, 0}), Codes{}) << "hidden";
    EXPECT_EQ(found_by(memory, {at(10), at(30)}, {0, kChangeConfirmed}), Codes{code_at(20)})
        << "no change of its surface";
    EXPECT_EQ(found_by(memory, {at(25), at(30)}, {kChangeConfirmed, 0}), Codes{code_at(20)})
        << "seen through";
    EXPECT_EQ(found_by(memory, {std::nullopt, at(30)}, {kChangeConfirmed, 0}), Codes{});
}

TEST(EndMemory, does_not_spare_for_a_hidden_pixel_what_another_leaves) {
    EndMemory memory;
    keep(memory, {at(20), at(20)});
    EXPECT_EQ(found_by(memory, {at(10), at(21)}, {kChangeConfirmed, 0}), Codes{code_at(20)});
}

TEST(EndMemory, takes_nothing_for_one_wrong_image) {
    EndMemory memory;
    keep(memory, {at(20), at(20), at(22)});
    for (const auto& wrong : {at(30), at(10)}) {
        const std::vector<std::uint8_t> changes{kChangeFound, 0, 0};
        EXPECT_EQ(found_by(memory, {wrong, at(20), at(22)}, changes), Codes{});
        EXPECT_EQ(found_by(memory, {wrong, at(21), at(22)}, changes), Codes{})
            << "it still states what it did";
        keep(memory, {wrong, at(20), at(22)}, changes);
        EXPECT_EQ(found_by(memory, {at(20), at(20), at(22)}, changes), Codes{}) << "right again";
        keep(memory, {at(20), at(20), at(22)}, changes);
    }
}

TEST(EndMemory, retracts_when_the_next_image_confirms_the_change) {
    EndMemory memory;
    keep(memory, {at(20), at(25)});
    keep(memory, {at(30), at(25)}, {kChangeFound, 0});
    EXPECT_EQ(found_by(memory, {at(30), at(25)}, {kChangeConfirmed, 0}), Codes{code_at(20)});
    keep(memory, {at(30), at(25)}, {kChangeConfirmed, 0});
    EXPECT_EQ(found_by(memory, {at(31), at(25)}), Codes{code_at(30)});
}

// Without an earlier end there is nothing to keep.
TEST(EndMemory, remembers_the_first_end_of_a_pixel_at_once) {
    EndMemory memory;
    keep(memory, {std::nullopt});
    keep(memory, {at(30)}, {kChangeFound});
    EXPECT_EQ(found_by(memory, {at(31)}), Codes{code_at(30)});
}

TEST(EndMemory, only_remembers_what_is_kept) {
    EndMemory memory;
    keep(memory, {at(20)});
    EXPECT_EQ(found_by(memory, {at(21)}), Codes{code_at(20)});
    EXPECT_EQ(found_by(memory, {at(22)}), Codes{code_at(20)});
    EndMemory resumed;
    resumed.resume_with({memory.ends().begin(), memory.ends().end()});
    EXPECT_EQ(found_by(resumed, {at(22)}), Codes{code_at(20)});
    EXPECT_TRUE(std::ranges::equal(resumed.ends(), memory.ends()));
}

/// The oracle: the definition with sets of voxels.
class PlainMemory {
  public:
    [[nodiscard]] Codes find(const Places& now, const std::vector<std::uint8_t>& changes) const {
        std::set<MortonCode> left;
        for (std::size_t i = 0; i < last_.size(); ++i) {
            if (!last_[i] || !now[i] || last_[i]->key == now[i]->key) continue;
            if (changes[i] == kChangeFound) continue;
            const bool is_hidden = changes[i] == kChangeConfirmed && now[i]->depth_m < last_[i]->depth_m;
            if (!is_hidden) left.insert(morton_of(last_[i]->key));
        }
        for (std::size_t i = 0; i < last_.size(); ++i) {
            if (now[i]) left.erase(morton_of(now[i]->key));
            const bool is_held = !now[i] || changes[i] == kChangeFound;
            if (is_held && last_[i]) left.erase(morton_of(last_[i]->key));
        }
        return {left.begin(), left.end()};
    }
    void keep(const Places& now, const std::vector<std::uint8_t>& changes) {
        last_.resize(now.size());
        for (std::size_t i = 0; i < now.size(); ++i)
            if (now[i] && !(last_[i] && changes[i] == kChangeFound)) last_[i] = now[i];
    }
    void forget() { last_.clear(); }

  private:
    Places last_;
};

TEST(EndMemory, is_its_definition_for_random_images) {
    std::size_t found = 0;
    for (unsigned seed = 1; seed <= 60; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        const auto below = [&](std::uint32_t limit) { return static_cast<std::uint32_t>(random() % limit); };
        const std::uint32_t pixels = 1 + below(60);
        const std::uint32_t edge = 1 + below(4);  // of the space that is seen, over the corner of 8 bricks
        const auto key = [&] {
            const auto axis = [&] { return static_cast<std::uint16_t>(32768 - 1 + below(edge)); };
            return VoxelKey{axis(), axis(), axis()};
        };
        EndMemory memory;
        PlainMemory plain;
        for (int number = 0; number < 40; ++number) {
            Places now;
            std::vector<std::uint8_t> changes;
            for (std::uint32_t i = 0; i < pixels; ++i) {
                now.emplace_back();
                if (below(4) != 0) now.back() = Place{key(), 0.1F * static_cast<float>(below(5))};
                changes.push_back(static_cast<std::uint8_t>(below(3)));
            }
            const Codes expected = plain.find(now, changes);
            ASSERT_EQ(found_by(memory, now, changes, {key(), key(), key()}), expected) << number;
            found += expected.size();
            if (below(10) == 0) {
                memory.forget();
                plain.forget();
            }
            if (below(5) != 0) {
                keep(memory, now, changes);
                plain.keep(now, changes);
            }
        }
    }
    EXPECT_GT(found, 1000U);
}

}  // namespace
}  // namespace octoskin
