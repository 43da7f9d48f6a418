// A field makes no difference to an answer: what is asked with one is asked without, too.
#include "host/apps/query/kept_field.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "host/apps/query/query_answer.hpp"
#include "tests/support/cases.hpp"
#include "tests/unit/host/core/query/two_joint_arm.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMany = 60;

/// A ball of 0.1 m that goes along x and has its reach about it.
AskedSpace along_x(double from, double to, std::size_t postures = kMany, double reach_m = 0.3) {
    AskedSpace asked;
    asked.reach_m = reach_m;
    for (std::size_t i = 0; i < postures; ++i) {
        const double x = from + (to - from) * static_cast<double>(i) / static_cast<double>(postures);
        asked.include(std::vector<PosedCapsule>{{{x, 0, 0}, {x, 0, 0.1}, 0.1}});
    }
    return asked;
}

TEST(KeptField, is_made_for_many_postures_and_then_serves_a_single_one) {
    const FusedMap map = free_about_origin();
    KeptField kept;
    EXPECT_EQ(kept.of(map, along_x(0.0, 0.5, 1)), nullptr);
    EXPECT_EQ(kept.of(map, along_x(0.0, 0.5, KeptField::kPosturesMin - 1)), nullptr);
    EXPECT_FALSE(kept.is_there()) << "whoever asks little pays nothing";
    const DistanceField* const made = kept.of(map, along_x(0.0, 0.5));
    ASSERT_NE(made, nullptr);
    EXPECT_GE(made->axis_reach_m(), 0.4);
    EXPECT_EQ(kept.of(map, along_x(0.2, 0.3, 1)), made) << "nothing has changed since";
    kept.drop();
    EXPECT_FALSE(kept.is_there());
}

TEST(KeptField, is_not_brought_up_to_date_for_less_than_that_costs) {
    FusedMap map = free_about_origin();
    KeptField kept;
    ASSERT_NE(kept.of(map, along_x(0.0, 0.5)), nullptr);
    std::vector<VoxelUpdate> updates;
    map.for_each_known([&](VoxelKey key, float) { updates.push_back({key, 0.01F}); });
    feed(map, updates);
    EXPECT_EQ(kept.of(map, along_x(0.0, 0.5, 1)), nullptr) << "512 bricks were written";
    const DistanceField* const field = kept.of(map, along_x(0.0, 0.5));
    ASSERT_NE(field, nullptr);
    EXPECT_EQ(field->map().log_odds(updates.front().key), map.log_odds(updates.front().key));
}

TEST(KeptField, becomes_one_for_all_that_was_asked_about) {
    const FusedMap map = free_about_origin();
    KeptField kept;
    const auto tells = [](const DistanceField* field, double x) {
        return field != nullptr && field->tells_of({{x, 0, 0}, {x, 0, 0.1}, 0.1});
    };
    EXPECT_TRUE(tells(kept.of(map, along_x(0.0, 0.5)), 0.0));
    const DistanceField* const both = kept.of(map, along_x(-0.9, -0.5));
    EXPECT_TRUE(tells(both, -0.9));
    EXPECT_TRUE(tells(both, 0.45));
    EXPECT_EQ(kept.of(map, along_x(-0.5, 0.4, 1)), both);
    EXPECT_GE(kept.of(map, along_x(0.0, 0.5, kMany, 0.6))->axis_reach_m(), 0.7);
}

TEST(KeptField, is_none_that_would_be_too_large) {
    const FusedMap map = free_about_origin();
    KeptField kept;
    EXPECT_EQ(kept.of(map, along_x(0.0, 0.5, kMany, 5.0)), nullptr) << "more than 120 voxels of reach";
    EXPECT_EQ(kept.of(map, along_x(-500.0, 500.0)), nullptr) << "23,000 bricks along x alone";
    EXPECT_FALSE(kept.is_there());
    ASSERT_NE(kept.of(map, along_x(-20.0, -19.0)), nullptr);
    const DistanceField* const other = kept.of(map, along_x(20.0, 21.0, kMany, 4.0));
    ASSERT_NE(other, nullptr) << "both together would be too large, this one alone is not";
    EXPECT_FALSE(other->tells_of({{-20, 0, 0}, {-20, 0, 0.1}, 0.1}));
}

TEST(KeptField, is_of_another_map_if_that_has_other_voxels) {
    const FusedMap map = free_about_origin();
    FusedMap finer(MapConfig{.resolution_m = 0.02});
    KeptField kept;
    ASSERT_NE(kept.of(map, along_x(0.0, 0.5)), nullptr);
    const DistanceField* const field = kept.of(finer, along_x(0.0, 0.5));
    ASSERT_NE(field, nullptr);
    EXPECT_EQ(field->map().resolution_m(), 0.02);
}

/// While another thread writes the map, some voxels at a time.
TEST(KeptField, makes_no_difference_to_what_is_answered_while_the_map_is_written) {
    const TwoJointArm arm;
    FusedMap map = free_about_origin();
    std::mutex mutex;
    const auto copy = [&] {
        const std::scoped_lock lock(mutex);
        return map.copy();
    };
    std::jthread writer([&](const std::stop_token& ends) {
        std::mt19937 random(1);
        std::uniform_real_distribution<double> along(-0.8, 0.8);
        std::deque<VoxelKey> marked;
        const auto add = [&](VoxelKey key, float log_odds) {
            const VoxelUpdate update{key, log_odds};
            const std::scoped_lock lock(mutex);
            feed(map, std::span(&update, 1));
        };
        while (!ends.stop_requested()) {
            marked.push_back(*map.key_of({along(random), along(random), along(random)}));
            add(marked.back(), 4.0F);
            if (marked.size() <= 12) continue;
            add(marked.front(), -4.0F);
            marked.pop_front();
        }
    });
    std::mt19937 random(2);
    std::uniform_real_distribution<double> turn(-3.0, 3.0);
    std::uniform_real_distribution<double> slide(0.0, 0.2);
    KeptField kept;
    unsigned by_field = 0;
    unsigned distances = 0;
    const unsigned cases = testing_support::cases(40);
    for (unsigned i = 0; i < cases; ++i) {
        QueryRequest request;
        for (auto n = random() % 4 + 1; n > 0; --n) request.path.push_back({turn(random), slide(random)});
        if (i % 5 == 4) request.path.resize(1);
        if (i % 3 == 2) request.own_space_m = 0.05;
        request.reach_m = i % 2 == 0 ? 0.5 : 0.2;
        request.padding_m = 0.01;
        const FusedMap now = copy();
        const auto ask = [&](KeptField* field) {
            Json answer = answer_query(request, {&arm.rig, &arm.robot, now.copy(), {}, field});
            answer.erase("took_us");
            return answer;
        };
        Json with = ask(&kept);
        Json without = ask(nullptr);
        EXPECT_EQ(without.at("distances"), "search");
        by_field += with.at("distances") == "field" ? 1U : 0U;
        with.erase("distances");
        without.erase("distances");
        ASSERT_EQ(with, without) << "case " << i;
        for (const Json& leg : with.at("legs"))
            distances += leg.at("not_free_m").is_number() && leg.at("not_free_m") > 0.0 ? 1U : 0U;
    }
    EXPECT_GT(by_field, cases / 4);
    EXPECT_GT(distances, cases / 4);
}

}  // namespace
}  // namespace octoskin
