#include "host/apps/explain/explanation.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "host/apps/explain/voxel_trace.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {
namespace {

using namespace test;

constexpr std::size_t kKept = 100;

/// Several voxels watched in one run.
class Traces final : public CommitListener {
  public:
    void on_time(std::optional<HostTime> now, std::span<const FedMap> maps) override {
        for (VoxelTrace& trace : all) trace.on_time(now, maps);
    }
    void on_joints(const JointMeasurement& joints) override {
        for (VoxelTrace& trace : all) trace.on_joints(joints);
    }
    void on_reading(const RangeMeasurement& reading, const Beam& beam,
                    std::span<const VoxelUpdate> updates) override {
        for (VoxelTrace& trace : all) trace.on_reading(reading, beam, updates);
    }
    void on_depth(const DepthFrame& frame, const Evidence& terms) override {
        for (VoxelTrace& trace : all) trace.on_depth(frame, terms);
    }
    void on_maps(std::span<const FedMap> maps) override {
        for (VoxelTrace& trace : all) trace.on_maps(maps);
    }
    std::vector<VoxelTrace> all;
};

Evidence terms_of(const std::vector<VoxelUpdate>& updates) {
    Evidence terms{.miss = -0.4F, .bricks = {}, .cells = {}};
    terms.take_image(updates);
    return terms;
}

void play(const Scene& scene, Pipeline& pipeline) {
    auto depth = scene.depth.begin();
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
        while (depth != scene.depth.end() && pipeline.now() && depth->captured <= *pipeline.now())
            pipeline.on_depth(*depth++);
    }
    pipeline.finish();
}

Explanation explanation_of(VoxelTrace trace, Occupancy occupancy) {
    return {.p_map = {0.0, 0.5, 0.0},
            .centre = {0.02, 0.5, 0.02},
            .resolution_m = 0.04,
            .occupancy = occupancy,
            .trace = std::move(trace),
            .begin = HostTime{0},
            .names = {{BeamSource{}, "camera"}, {BeamSource{1, 3, 0}, "forearm_3"}},
            .warnings = {}};
}

/// Goes on from a map in which the voxel has this log-odds.
VoxelTrace cross_check_from(VoxelKey key, float log_odds, std::size_t kept_max = kKept) {
    FusedMap map{MapConfig{}};
    EXPECT_TRUE(map.set_cube({key, 0}, log_odds));
    VoxelTrace trace(key, MapConfig{}, kept_max);
    trace.on_begin(map);
    return trace;
}

RangeMeasurement reading_at(double time_s) {
    return {{1, 3, 0}, {std::llround(time_s * 1e9)}, 0.52, 0.01};
}

// The oracle is the map itself: it applies the terms on its own.
TEST(VoxelTrace, sums_up_to_the_maps_log_odds_bit_for_bit_clamping_included) {
    Scene scene = good_scene();
    scene.depth.resize(2);
    scene.mapping.map.log_odds_max = 1.5F;  // so that ten readings reach it
    Pipeline first = make_pipeline(scene);
    play(scene, first);
    Traces traces;
    std::size_t seen = 0;
    first.map().for_each_known([&](VoxelKey key, float) {
        if (seen++ % 997 == 0) traces.all.emplace_back(key, scene.mapping.map, kKept);
    });
    first.map(MapFeed::ranges).for_each_known([&](VoxelKey key, float) {
        traces.all.emplace_back(key, scene.mapping.map, kKept);
    });
    Pipeline pipeline = make_pipeline(scene);
    pipeline.set_listener(&traces);
    play(scene, pipeline);
    std::size_t clamped = 0;
    for (const VoxelTrace& trace : traces.all) {
        ASSERT_TRUE(trace.log_odds());
        EXPECT_EQ(trace.log_odds(), pipeline.map().log_odds(trace.key()));
        double sum = 0.0;
        std::uint64_t count = 0;
        for (const Contribution& contribution : trace.newest()) sum += contribution.change();
        EXPECT_NEAR(sum, static_cast<double>(*trace.log_odds()), 1e-12);
        double by_source = 0.0;
        for (const auto& [source, share] : trace.shares()) {
            by_source += share.change;
            count += share.hits + share.misses;
        }
        EXPECT_NEAR(by_source, sum, 1e-12);
        EXPECT_EQ(count, trace.newest().size());
        clamped += *trace.log_odds() == scene.mapping.map.log_odds_max ? 1U : 0U;
    }
    EXPECT_GT(traces.all.size(), 20U);
    EXPECT_GT(clamped, 0U) << "no clamp was tried";
    EXPECT_TRUE(std::ranges::any_of(traces.all, [](const VoxelTrace& trace) {
        return trace.shares().contains(BeamSource{});
    })) << "no depth frame took part";
}

TEST(VoxelTrace, goes_on_from_the_map_that_was_there_and_keeps_the_newest) {
    const VoxelKey key{1, 2, 3};
    VoxelTrace trace = cross_check_from(key, 3.0F, 2);
    const std::vector<VoxelUpdate> updates{{key, 0.3F}, {{1, 2, 4}, 5.0F}};
    for (int i = 0; i < 5; ++i) trace.on_reading(reading_at(1.0 + i), Beam{}, updates);
    EXPECT_EQ(trace.log_odds(), 3.5F) << "clamped";
    EXPECT_EQ(trace.count(), 5U);
    ASSERT_EQ(trace.newest().size(), 2U);
    EXPECT_EQ(trace.newest().back().captured.ns, 5'000'000'000);
    EXPECT_EQ(trace.newest().back().change(), 0.0);
    EXPECT_NEAR(trace.shares().at({1, 3, 0}).change, 0.5, 1e-12);
    EXPECT_EQ(trace.shares().at({1, 3, 0}).hits, 5U);
}

TEST(VoxelTrace, says_what_the_map_says_where_sensors_that_see_a_cone_have_counted) {
    const VoxelKey key{1, 2, 3};
    MapConfig config;
    FusedMap map(config);
    VoxelTrace trace(key, config, kKept);
    const ConeModel model;
    const ConeVoxels at{.passed = {}, .cap = {{key, 1.0F}}, .middle = {}};
    const ConeVoxels through{.passed = {key}, .cap = {}, .middle = {}};
    double sum = 0.0;
    std::size_t known = 0;
    for (int i = 0; i < 40; ++i) {
        if (i % 4 == 3) {
            const Evidence terms = terms_of({{key, i % 3 == 0 ? 0.7F : -0.4F}});
            feed(map, terms);
            trace.on_depth({{1'000'000 * i}, 0, 0, {}}, terms);
        } else {
            std::vector<VoxelUpdate> changes;
            feed(map, i / 5 % 2 == 0 ? at : through, model, false, &changes);
            trace.on_reading(reading_at(1e-3 * i), Beam{}, changes);
        }
        trace.on_fused(map);
        ASSERT_EQ(trace.log_odds(), map.log_odds(key)) << i;
        known += map.log_odds(key) ? 1U : 0U;
    }
    for (const auto& [source, share] : trace.shares()) sum += share.change;
    EXPECT_GT(known, 20U);
    EXPECT_NEAR(sum, static_cast<double>(map.log_odds(key).value()), 1e-5);
}

TEST(Explanation, concludes_in_one_sentence) {
    const VoxelKey key{1, 2, 3};
    const std::vector<VoxelUpdate> hit{{key, 0.9F}};
    const std::vector<VoxelUpdate> miss{{key, -0.4F}};
    VoxelTrace ghost(key, MapConfig{}, kKept);
    ghost.on_reading(reading_at(4.1), Beam{}, hit);
    ghost.on_reading(reading_at(4.6), Beam{}, hit);
    EXPECT_EQ(
        conclusion_of(explanation_of(ghost, Occupancy::occupied)),
        "occupied, mainly by sensor forearm_3 between 4.100 and 4.600 s, 2 hits; the camera never saw it");
    ghost.on_depth({{4'700'000'000}, 0, 0, {}}, terms_of(miss));
    EXPECT_EQ(
        conclusion_of(explanation_of(ghost, Occupancy::occupied)),
        "occupied, mainly by sensor forearm_3 between 4.100 and 4.600 s, 2 hits; the camera saw it free in "
        "1 frame, and never occupied");
    VoxelTrace clamped(key, MapConfig{}, kKept);
    for (int i = 0; i < 9; ++i) clamped.on_reading(reading_at(4.1), Beam{}, miss);
    for (int i = 0; i < 61; ++i) clamped.on_depth({{4'200'000'000}, 0, 0, {}}, terms_of(miss));
    EXPECT_EQ(conclusion_of(explanation_of(clamped, Occupancy::free)),
              "free, mainly by sensor forearm_3 at 4.100 s, 9 misses; the camera saw it free in 61 frames, "
              "and never occupied")
        << "though at the clamp that changed nothing";
    VoxelTrace marked(key, MapConfig{}, kKept);
    for (int i = 0; i < 2; ++i) marked.on_reading(reading_at(4.1), Beam{}, hit);
    marked.on_depth({{4'200'000'000}, 0, 0, {}}, terms_of(hit));
    EXPECT_EQ(
        conclusion_of(explanation_of(marked, Occupancy::occupied)),
        "occupied, mainly by sensor forearm_3 at 4.100 s, 2 hits; the camera saw it occupied in 1 frame, "
        "and never free");
    VoxelTrace freed(key, MapConfig{}, kKept);
    freed.on_depth({{4'700'000'000}, 0, 0, {}}, terms_of(miss));
    EXPECT_EQ(conclusion_of(explanation_of(freed, Occupancy::free)),
              "free, mainly by the camera at 4.700 s, 1 miss");
    EXPECT_EQ(conclusion_of(explanation_of(VoxelTrace(key, MapConfig{}, kKept), Occupancy::unknown)),
              "unknown: no reading and no depth frame ever reached it");
    EXPECT_EQ(conclusion_of(explanation_of(cross_check_from(key, 1.0F), Occupancy::occupied)),
              "occupied, unchanged since the beginning of the recording; the camera never saw it");
}

TEST(Explanation, tells_of_each_camera_of_several) {
    const VoxelKey key{1, 2, 3};
    const Evidence hit = terms_of({{key, 0.9F}});
    const Evidence miss = terms_of({{key, -0.4F}});
    VoxelTrace trace(key, MapConfig{}, kKept);
    for (int i = 0; i < 3; ++i)
        trace.on_depth({.captured = {4'100'000'000}, .depth_mm = {}, .camera = 1}, hit);
    trace.on_depth({.captured = {4'200'000'000}, .depth_mm = {}, .camera = 0}, miss);
    EXPECT_EQ(trace.newest().back().frame, 0U) << "each camera's frames are counted";
    EXPECT_EQ(trace.newest()[2].frame, 2U);
    Explanation explanation = explanation_of(trace, Occupancy::occupied);
    explanation.cameras = {"left", "right", "rear"};
    for (std::size_t i = 0; i < explanation.cameras.size(); ++i)
        explanation.names[source_of_camera(i)] = "camera '" + explanation.cameras[i] + "'";
    EXPECT_EQ(
        conclusion_of(explanation),
        "occupied, mainly by camera 'right' at 4.100 s, 3 hits; camera 'left' saw it free in 1 frame, and "
        "never occupied; camera 'rear' never saw it");
    const auto json = to_json(explanation);
    EXPECT_EQ(json["sources"][0]["source"]["name"], "camera");
    EXPECT_EQ(json["sources"][0]["source"]["camera"], "right");
}

TEST(Explanation, weighs_what_was_there_before_as_a_line_of_its_own_and_the_sum_agrees) {
    const VoxelKey key{1, 2, 3};
    VoxelTrace trace = cross_check_from(key, 2.0F);
    const std::vector<VoxelUpdate> miss{{key, -0.5F}};
    const std::vector<VoxelUpdate> hit{{key, 0.75F}};
    trace.on_reading(reading_at(4.1), Beam{}, hit);
    trace.on_depth({{4'200'000'000}, 0, 0, {}}, terms_of(miss));
    const std::string text = to_text(explanation_of(trace, Occupancy::occupied));
    EXPECT_EQ(text.substr(0, text.find("the newest")),
              "voxel about 0.020 0.500 0.020 m, edge 0.04 m: occupied, log-odds 2.2500\n"
              "  source                     hits  misses  log-odds    first s    last s\n"
              "  before the recording          -       -   +2.0000\n"
              "  forearm_3                     1       0   +0.7500      4.100     4.100\n"
              "  camera                        0       1   -0.5000      4.200     4.200\n");
    EXPECT_EQ(conclusion_of(explanation_of(trace, Occupancy::occupied)),
              "occupied, mainly from the map before the recording; the camera saw it free in 1 frame, "
              "and never occupied");
    VoxelTrace weaker = cross_check_from(key, 0.5F);
    weaker.on_reading(reading_at(4.1), Beam{}, hit);
    EXPECT_EQ(conclusion_of(explanation_of(weaker, Occupancy::occupied)),
              "occupied, mainly by sensor forearm_3 at 4.100 s, 1 hit; the camera never saw it");
    VoxelTrace against = cross_check_from(key, -1.0F);
    for (int i = 0; i < 3; ++i) against.on_reading(reading_at(4.1), Beam{}, hit);
    EXPECT_EQ(conclusion_of(explanation_of(against, Occupancy::occupied)),
              "occupied, mainly by sensor forearm_3 at 4.100 s, 3 hits; the camera never saw it")
        << "it was free before";
}

HostTime time_at(double time_s) {
    return {std::llround(time_s * 1e9)};
}

// The oracle is the map itself.
TEST(VoxelTrace, knows_when_what_was_there_expired_and_what_came_since) {
    Scene scene = good_scene();
    scene.mapping.map.age = {.stale_after_s = 2, .unknown_after_s = 5};
    MapBuilder builder =
        MapBuilder::build(scene.rig, one_joint_robot(), scene.mapping, {}, {MapFeed::both}).value();
    const auto integrate = [&](double time_s) {
        for (const double beside_s : {-0.01, 0.01})
            ASSERT_TRUE(builder.add({time_at(time_s + beside_s), {M_PI / 2.0}}));
        ASSERT_TRUE(builder.integrate(flat_frame(time_s)));
    };
    integrate(3.5);
    Traces traces;
    builder.map().for_each_known([&](VoxelKey key, float) {
        if (traces.all.size() < 20) traces.all.emplace_back(key, scene.mapping.map, kKept);
    });
    for (VoxelTrace& trace : traces.all) trace.on_begin(builder.map());
    builder.set_listener(&traces);
    for (const double beside_s : {-0.01, 0.01})
        ASSERT_TRUE(builder.add({time_at(9.5 + beside_s), {M_PI / 2.0}}));
    ASSERT_TRUE(builder.integrate(RangeMeasurement{{kLeft, kGood, 0}, time_at(9.5), 0.52, 0.01}));
    std::size_t gone = 0;
    for (const VoxelTrace& trace : traces.all) {
        EXPECT_EQ(trace.log_odds(), builder.map().log_odds(trace.key()));
        EXPECT_EQ(trace.forgotten().times, 1U);
        EXPECT_EQ(trace.forgotten().change, -static_cast<double>(*trace.begin()));
        EXPECT_EQ(trace.forgotten().last, time_at(9.5));
        gone += trace.log_odds() ? 0U : 1U;
    }
    EXPECT_GT(gone, 0U);
    integrate(10.0);
    integrate(16.5);  // what it frees expired by then, and before it frees it again
    for (const VoxelTrace& trace : traces.all) {
        EXPECT_EQ(trace.log_odds(), builder.map().log_odds(trace.key()));
        EXPECT_NEAR(trace.sum(), static_cast<double>(trace.log_odds().value_or(0.0F)), 1e-9);
        EXPECT_EQ(trace.forgotten().times, 2U);
        EXPECT_FALSE(trace.forgotten().is_last);
        EXPECT_EQ(trace.newest().back().before, 0.0F);
    }
}

TEST(VoxelTrace, knows_what_expired_while_a_saved_map_waited) {
    Scene scene = good_scene();
    scene.mapping.map.age = {.stale_after_s = 2, .unknown_after_s = 5};
    MapBuilder builder =
        MapBuilder::build(scene.rig, one_joint_robot(), scene.mapping, {}, {MapFeed::both}).value();
    const VoxelKey key{1, 2, 3};
    FusedMap saved(scene.mapping.map);
    saved.advance_time(time_at(1.0));
    feed(saved, terms_of({{key, 0.7F}}));
    saved.begin_to_wait();
    VoxelTrace trace(key, scene.mapping.map, kKept);
    trace.on_begin(saved);
    builder.begin_with(std::move(saved));
    builder.set_listener(&trace);
    builder.wait(3);
    EXPECT_EQ(trace.forgotten().times, 0U);
    builder.wait(8);
    EXPECT_EQ(builder.map().log_odds(key), std::nullopt);
    EXPECT_EQ(trace.log_odds(), std::nullopt);
    EXPECT_EQ(trace.forgotten().times, 1U);
    EXPECT_EQ(trace.forgotten().last, std::nullopt);
    EXPECT_NEAR(trace.sum(), 0.0, 1e-9);
}

TEST(Explanation, tells_that_a_voxel_was_forgotten_and_not_what_marked_it_before) {
    const VoxelKey key{1, 2, 3};
    VoxelTrace trace = cross_check_from(key, 2.0F);
    const std::vector<VoxelUpdate> hit{{key, 0.75F}};
    trace.on_reading(reading_at(4.1), Beam{}, hit);
    trace.on_older(time_at(9.25), FusedMap{MapConfig{}});
    const auto json = to_json(explanation_of(trace, Occupancy::unknown));
    EXPECT_EQ(json["log_odds"], nullptr);
    EXPECT_EQ(json["forgotten"]["times"], 1);
    EXPECT_EQ(json["forgotten"]["change"], -2.75);
    EXPECT_EQ(json["forgotten"]["last_s"], 9.25);
    EXPECT_EQ(json["sources"][0]["change"], 0.75);
    EXPECT_NE(json["conclusion"].get<std::string>().find("unknown, expired at 9.250 s"), std::string::npos);
    EXPECT_NE(to_text(explanation_of(trace, Occupancy::unknown)).find("  -2.7500                9.250\n"),
              std::string::npos);
    trace.on_depth({time_at(10.5), 0, 0, {}}, terms_of({{key, 0.5F}}));
    EXPECT_EQ(conclusion_of(explanation_of(trace, Occupancy::occupied)),
              "occupied, mainly by the camera at 10.500 s, 1 hit");
}

TEST(Explanation, says_that_a_full_map_had_no_room) {
    Explanation explanation = explanation_of(VoxelTrace({1, 2, 3}, MapConfig{}, kKept), Occupancy::unknown);
    explanation.no_room = 12;
    EXPECT_EQ(conclusion_of(explanation),
              "unknown: the map was full and had no room for 12 contributions to it; raise "
              "map.memory_max_mib in the mapping file");
    EXPECT_EQ(to_json(explanation)["contributions_without_room"], 12);
}

TEST(Explanation, says_the_same_as_json) {
    const VoxelKey key{1, 2, 3};
    VoxelTrace trace = cross_check_from(key, 0.5F);
    Beam beam;
    beam.p_map_sensor = {1.0, 2.0, 3.0};
    const std::vector<VoxelUpdate> hit{{key, 0.75F}};
    trace.on_reading(reading_at(4.1), beam, hit);
    const auto json = to_json(explanation_of(trace, Occupancy::occupied));
    EXPECT_EQ(json["log_odds"], 1.25);
    EXPECT_EQ(json["log_odds_at_begin"], 0.5);
    EXPECT_EQ(json["contributions"][0]["change"], 0.75);
    EXPECT_EQ(json["contributions"][0]["sensor_m"], (std::vector<double>{1.0, 2.0, 3.0}));
    EXPECT_EQ(json["contributions"][0]["source"]["name"], "forearm_3");
    EXPECT_EQ(json["contributions"][0]["time_s"], 4.1);
}

}  // namespace
}  // namespace octoskin
