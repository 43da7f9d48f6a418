// The request `voxel`: the map's own values, and refusals.
#include "host/apps/query/voxel_answer.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/core/mapping/voxel_brick.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

FusedMap map_with_time() {
    MapConfig config;
    config.age = {.stale_after_s = 60, .unknown_after_s = 600};
    FusedMap map(config);
    map.advance_time({1'000'000'000});
    return map;
}

Json ask(const FusedMap& map, const Eigen::Vector3d& point) {
    return answer_voxel("voxel " + Json{{"point_m", {point.x(), point.y(), point.z()}}}.dump(), map);
}

TEST(VoxelAnswer, has_the_state_the_counts_and_the_age_of_the_map) {
    FusedMap map = map_with_time();
    const VoxelKey wall{32'790, 32'760, 32'770};
    const VoxelKey air{32'780, 32'760, 32'770};
    feed(map, std::vector<VoxelUpdate>{{wall, 2.0F}}, SensorKind::camera);
    feed(map, std::vector<VoxelUpdate>{{air, -1.5F}}, SensorKind::range);
    map.advance_time({31'000'000'000});
    const Json occupied = ask(map, map.centre_of(wall));
    EXPECT_EQ(occupied["ok"], true);
    EXPECT_EQ(occupied["key"], Json({wall.x, wall.y, wall.z}));
    EXPECT_EQ(occupied["state"], "occupied");
    EXPECT_EQ(occupied["log_odds"], voxel_state(map.layers(), wall).log_odds);
    EXPECT_EQ(occupied["age_s"], 30);
    EXPECT_EQ(occupied["kind"], "camera");
    EXPECT_TRUE(occupied["hits"].is_null());
    const Json free = ask(map, map.centre_of(air));
    EXPECT_EQ(free["state"], "free");
    EXPECT_EQ(free["kind"], "range");
    map.advance_time({100'000'000'000});
    EXPECT_EQ(ask(map, map.centre_of(air))["state"], "stale");
    EXPECT_EQ(ask(map, map.centre_of(wall))["state"], "occupied");
    const Json unknown = ask(map, {50, 50, 50});
    EXPECT_EQ(unknown["state"], "unknown");
    EXPECT_TRUE(unknown["log_odds"].is_null());
    EXPECT_TRUE(unknown["age_s"].is_null());
}

TEST(VoxelAnswer, refuses_what_is_no_point_of_the_map) {
    const FusedMap map = map_with_time();
    for (const char* line : {"voxel ", "voxel {}", "voxel [1,2,3]", "voxel {\"point_m\":[1,2]}",
                             "voxel {\"point_m\":[1,2,\"3\"]}", "voxel {\"point_m\":[1,2,null]}",
                             "voxel {\"point_m\":[1,2,3],\"more\":1}", "voxel {\"point_m\":[1e999,0,0]}",
                             "voxel {\"point_m\":[1,2,3]", "voxel [[[[[[[[[["}) {
        const Json answer = answer_voxel(line, map);
        EXPECT_EQ(answer["ok"], false) << line;
        EXPECT_EQ(answer["error"]["code"], "bad_argument") << line;
    }
    EXPECT_EQ(ask(map, {1e6, 0, 0})["error"]["code"], "out_of_range");
}

TEST(VoxelAnswer, is_asked_for_by_its_word) {
    EXPECT_TRUE(is_voxel_request("voxel {}"));
    EXPECT_TRUE(is_voxel_request("voxel{}"));
    EXPECT_FALSE(is_voxel_request("voxel"));
    EXPECT_FALSE(is_voxel_request("voxels {}"));
}

}  // namespace
}  // namespace octoskin
