#include "host/apps/query/query_answer.hpp"
#include "tests/support/evidence.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/core/mapping/mapping_config.hpp"
#include "host/core/query/path_query.hpp"
#include "tests/unit/host/core/query/two_joint_arm.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::ordered_json;

class QueryAnswer : public testing::Test {
  protected:
    Json ask(const QueryRequest& request, const FusedMap& map, std::vector<double> present = {}) const {
        return answer_query(request, {&arm_.rig, &arm_.robot, map.copy(), std::move(present)});
    }
    static QueryRequest path(std::vector<std::vector<double>> path) {
        QueryRequest request;
        request.path = std::move(path);
        return request;
    }
    TwoJointArm arm_;
    FusedMap map_ = free_about_origin();
};

TEST_F(QueryAnswer, of_a_posture_tells_state_link_voxel_and_distances) {
    mark(map_, {0.42, 0.02, 0.30});
    const Json answer = ask(path({{0.0, 0.0}}), map_);
    ASSERT_TRUE(answer.at("ok").get<bool>()) << answer;
    EXPECT_EQ(answer.at("state"), "occupied");
    ASSERT_EQ(answer.at("legs").size(), 1U);
    const Json& leg = answer.at("legs").at(0);
    EXPECT_EQ(leg.at("link"), "hand");
    EXPECT_NEAR(leg.at("voxel_m").at(0).get<double>(), 0.42, 1e-6);
    EXPECT_EQ(leg.at("occupied_m"), 0.0);
    EXPECT_EQ(leg.at("occupied_link"), "hand");
    EXPECT_THAT(query_text(answer), HasSubstr("occupied: hand at (0.420, 0.020, 0.300) m\n"));
}

TEST_F(QueryAnswer, of_a_free_posture_names_no_link) {
    const Json answer = ask(path({{0.0, 0.0}}), map_);
    EXPECT_EQ(answer.at("state"), "free");
    EXPECT_TRUE(answer.at("legs").at(0).at("link").is_null());
    EXPECT_TRUE(answer.at("legs").at(0).at("occupied_m").is_null());
    EXPECT_THAT(query_text(answer), testing::StartsWith("free\n"));
}

TEST_F(QueryAnswer, tells_the_weakest_evidence_of_free_space) {
    mark(map_, {0.42, 0.02, 0.30}, -0.6F);
    const Json answer = ask(path({{0.0, 0.0}, {1.5, 0.0}}), map_);
    EXPECT_EQ(answer.at("min_evidence"), 0.0);
    const Json& free = answer.at("legs").at(0).at("free_evidence");
    EXPECT_EQ(free.at("images"), 1.5);
    EXPECT_EQ(free.at("beams"), 0.0);
    EXPECT_EQ(free.at("link"), "hand");
    EXPECT_EQ(free.at("voxel_m"), Json({0.42, 0.02, 0.3}));
    EXPECT_THAT(query_text(answer), HasSubstr("  free by at least: 1.5 images and 0.0 beams, at (0.420, "));
    QueryGround ground{&arm_.rig, &arm_.robot, map_.copy(), {}};
    ground.units.log_odds = 0.2F;
    const Json in_other_units = answer_query(path({{0.0, 0.0}}), std::move(ground));
    EXPECT_EQ(in_other_units.at("legs").at(0).at("free_evidence").at("images"), 3.0);
    EXPECT_TRUE(
        ask(path({{0.0, 0.0}}), FusedMap{MapConfig{}}).at("legs").at(0).at("free_evidence").is_null());
}

TEST_F(QueryAnswer, with_a_minimum_of_evidence_takes_weaker_space_for_unknown) {
    mark(map_, {0.42, 0.02, 0.30}, -0.6F);
    QueryRequest request = path({{0.0, 0.0}});
    request.min_evidence = 1.5;
    EXPECT_EQ(ask(request, map_).at("state"), "free");
    request.min_evidence = 2.0;
    const Json answer = ask(request, map_, {0.0, 0.0});
    EXPECT_EQ(answer.at("state"), "unknown");
    EXPECT_EQ(answer.at("min_evidence"), 2.0);
    EXPECT_EQ(answer.at("legs").at(0).at("link"), "hand");
    request.own_space_m = 0.04;
    EXPECT_EQ(ask(request, map_, {0.0, 0.0}).at("state"), "free") << "its own space";
    EXPECT_EQ(ask(request, map_, {1.5, 0.0}).at("state"), "unknown");
}

TEST_F(QueryAnswer, of_a_path_is_that_of_what_lies_between_its_configurations) {
    mark(map_, {0.3, 0.3, 0.30});
    const Json answer = ask(path({{0.0, 0.0}, {1.5, 0.0}, {1.6, 0.0}}), map_);
    EXPECT_EQ(answer.at("state"), "occupied");
    EXPECT_EQ(answer.at("legs").at(0).at("state"), "free");
    EXPECT_EQ(answer.at("legs").at(1).at("state"), "occupied");
    EXPECT_EQ(answer.at("legs").at(2).at("state"), "free");
    EXPECT_THAT(query_text(answer), HasSubstr("the path is occupied: 3 configurations"));
}

TEST_F(QueryAnswer, without_a_path_is_that_of_the_arm_as_it_stands) {
    mark(map_, {0.02, 0.42, 0.30});
    EXPECT_EQ(ask({}, map_, {0.5 * M_PI, 0.0}).at("state"), "occupied");
    EXPECT_EQ(ask({}, map_, {0.0, 0.0}).at("state"), "free");
    const Json nobody = ask({}, map_);
    EXPECT_FALSE(nobody.at("ok").get<bool>());
    EXPECT_EQ(nobody.at("exit"), static_cast<int>(ExitCode::unavailable));
    EXPECT_EQ(nobody.at("error").at("code"), "no_data");
    EXPECT_THAT(nobody.at("error").at("remedy").get<std::string>(),
                AllOf(HasSubstr("--joints"), HasSubstr("--stands")));
}

TEST_F(QueryAnswer, of_a_small_region_tells_how_much_is_unknown_in_litres_and_of_none_why) {
    QueryRequest request;
    request.kind = QueryKind::pockets;
    request.radius_m = 0.1;
    request.z_min_m = -1.0;
    EXPECT_THAT(query_text(ask(request, FusedMap{MapConfig{}})), HasSubstr(" l unknown, 0 pockets"));
    request.z_min_m = 999.0;
    const Json error = ask(request, map_).at("error");
    EXPECT_EQ(error.at("code"), "out_of_range");
    EXPECT_EQ(error.at("key"), "z_min_m");
    EXPECT_EQ(error.at("value"), "999 m");
    EXPECT_THAT(error.at("remedy").get<std::string>(), HasSubstr("--above"));
}

TEST(QueryRefused, is_read_back_and_no_other_answer_is_one) {
    const Error why{.code = ErrorCode::out_of_range, .what = "why", .value = "3", .key = "step"};
    const Json answer = query_refused({ExitCode::usage, why});
    EXPECT_EQ(answer.at("ok"), false);
    EXPECT_EQ(answer.at("exit"), 64);
    EXPECT_EQ(answer.at("error").at("code"), "out_of_range");
    EXPECT_EQ(answer.at("error").at("key"), "step");
    const auto back = refusal_of(answer);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->exit, ExitCode::usage);
    EXPECT_EQ(back->error.code, why.code);
    EXPECT_EQ(back->error.value, why.value);
    EXPECT_EQ(back->message(), why.message());
    EXPECT_FALSE(refusal_of(Json{{"ok", true}, {"error", "none"}}));
    EXPECT_FALSE(refusal_of(Json::array()));
}

/// The arm without its upper arm's body, which has a <visual>.
void take_body_of_upper(HostRig& rig, bool is_listed) {
    rig.body.erase(rig.body.begin() + 1);
    rig.links_without_body = {{"upper", is_listed}};
}

TEST_F(QueryAnswer, tells_which_links_were_asked_about) {
    const Json whole = ask(path({{0.0, 0.0}}), map_);
    EXPECT_EQ(whole.at("links"), Json({"upper", "hand"}));
    EXPECT_EQ(whole.at("links_without_body"), Json::array());
    EXPECT_EQ(whole.at("links_unknown"), Json::array());
    QueryRequest request = path({{0.0, 0.0}});
    request.links_ignored = {"hand"};
    EXPECT_EQ(ask(request, map_).at("links"), Json({"upper"}));
    request.links_ignored.clear();
    request.asks_unmoved_links = true;
    EXPECT_EQ(ask(request, map_).at("links"), Json({"post", "upper", "hand"}));
}

TEST_F(QueryAnswer, of_a_link_without_a_body_is_unknown_where_it_would_be_free) {
    take_body_of_upper(arm_.rig, false);
    const Json answer = ask(path({{0.0, 0.0}, {0.5, 0.0}}), map_);
    EXPECT_EQ(answer.at("state"), "unknown");
    EXPECT_EQ(answer.at("legs").at(1).at("state"), "unknown");
    EXPECT_EQ(answer.at("legs").at(1).at("link"), "upper");
    EXPECT_TRUE(answer.at("legs").at(1).at("voxel_m").is_null());
    EXPECT_EQ(answer.at("links"), Json({"hand"}));
    EXPECT_EQ(answer.at("links_without_body"), Json({"upper"}));
    EXPECT_EQ(answer.at("links_unknown"), Json({"upper"}));
    EXPECT_THAT(query_text(answer), HasSubstr("   2  unknown: upper has no body\n"));
    EXPECT_THAT(query_text(answer), HasSubstr("not checked: upper: "));
    mark(map_, {0.42, 0.02, 0.30});
    const Json blocked = ask(path({{0.0, 0.0}}), map_);
    EXPECT_EQ(blocked.at("state"), "occupied");
    EXPECT_EQ(blocked.at("links_unknown"), Json({"upper"}));
    EXPECT_THAT(query_text(blocked), HasSubstr("not checked: upper: "));
    EXPECT_THAT(query_text(ask(path({{0.5, 0.0}}), map_)), HasSubstr("nearest occupied voxel: at most 0."));
}

TEST_F(QueryAnswer, of_a_link_without_a_body_is_unknown_whatever_the_question_leaves_out) {
    take_body_of_upper(arm_.rig, false);
    QueryRequest request = path({{0.0, 0.0}});
    request.links_ignored = {"upper"};
    EXPECT_EQ(ask(request, map_).at("state"), "unknown") << "what has no body is said in the rig";
    request.links_ignored = {"hand"};
    const Json nothing_asked = ask(request, map_);
    EXPECT_EQ(nothing_asked.at("state"), "unknown");
    EXPECT_EQ(nothing_asked.at("links"), Json::array());
    request.links_ignored.clear();
    request.own_space_m = 0.1;
    EXPECT_EQ(ask(request, map_).at("state"), "unknown") << "its own space is not known";
}

TEST_F(QueryAnswer, of_a_link_that_the_rig_lists_as_without_a_body_may_be_free) {
    take_body_of_upper(arm_.rig, true);
    const Json answer = ask(path({{0.0, 0.0}}), map_);
    EXPECT_EQ(answer.at("state"), "free");
    EXPECT_EQ(answer.at("links_without_body"), Json({"upper"}));
    EXPECT_EQ(answer.at("links_unknown"), Json::array());
    EXPECT_THAT(query_text(answer), HasSubstr("\nnot checked: upper: "));
}

TEST_F(QueryAnswer, tells_whose_body_stands_for_a_link_without_its_own) {
    EXPECT_EQ(ask(path({{0.0, 0.0}}), map_).at("links_with_borrowed_body"), Json::object());
    arm_.rig.links_with_borrowed_body = {{"mount", "hand"}};
    const Json answer = ask(path({{0.0, 0.0}}), map_);
    EXPECT_EQ(answer.at("state"), "free");
    EXPECT_EQ(answer.at("links_with_borrowed_body"), Json({{"mount", "hand"}}));
    EXPECT_THAT(query_text(answer),
                HasSubstr("checked with the body of hand, to which it is fixed: mount\n"));
}

TEST_F(QueryAnswer, of_an_arm_none_of_whose_links_has_a_body_is_unknown) {
    arm_.rig.body.clear();
    arm_.rig.links_without_body = {{"hand", false}, {"upper", false}};
    KeptField field;
    const Json answer =
        answer_query(path({{0.0, 0.0}, {0.5, 0.0}}), {&arm_.rig, &arm_.robot, map_.copy(), {}, &field});
    ASSERT_EQ(answer.at("ok"), true) << answer;
    EXPECT_EQ(answer.at("state"), "unknown");
    EXPECT_EQ(answer.at("links"), Json::array());
    EXPECT_EQ(answer.at("links_unknown"), Json({"hand", "upper"}));
    EXPECT_EQ(answer.at("legs").at(0).at("occupied_m"), nullptr);
}

TEST_F(QueryAnswer, of_a_view_into_a_pocket_calls_neither_it_nor_its_way_free) {
    const FusedMap holed = without(map_, {0.7, -0.1, 0.2}, {0.9, 0.1, 0.4});
    QueryRequest request = path({{0.0, 0.0}});
    request.kind = QueryKind::pockets;
    request.z_min_m = -1.0;
    const auto view = [&] { return ask(request, holed).at("pockets").at(0).at("view"); };
    ASSERT_FALSE(view().is_null());
    EXPECT_EQ(view().at("state"), "free");
    EXPECT_EQ(view().at("way"), "free");
    take_body_of_upper(arm_.rig, false);
    EXPECT_EQ(view().at("state"), "unknown");
    EXPECT_EQ(view().at("way"), "unknown");
    EXPECT_EQ(ask(request, holed).at("links_unknown"), Json({"upper"}));
    EXPECT_THAT(query_text(ask(request, holed)), HasSubstr("not checked: upper: "));
}

TEST_F(QueryAnswer, takes_the_arms_own_space_for_free_if_it_is_told_to) {
    const FusedMap holed = without(map_, {-0.1, -0.12, 0.2}, {0.5, 0.12, 0.4});
    QueryRequest request = path({{0.0, 0.0}});
    EXPECT_EQ(ask(request, holed).at("state"), "unknown");
    EXPECT_TRUE(ask(request, holed).at("own_space_m").is_null());
    request.own_space_m = 0.04;
    EXPECT_EQ(ask(request, holed).at("own_space_m"), 0.04);
    EXPECT_EQ(ask(request, holed).at("state"), "free") << "where the path begins";
    EXPECT_EQ(ask(request, holed, {0.0, 0.0}).at("state"), "free");
    EXPECT_EQ(ask(request, holed, {2.0, 0.0}).at("state"), "unknown") << "it stands elsewhere";
}

TEST_F(QueryAnswer, refuses_an_own_space_of_too_many_voxels) {
    MapConfig fine;
    fine.resolution_m = 0.002;
    QueryRequest request = path({{0.0, 0.0}});
    request.own_space_m = 1.0;
    const Json answer = ask(request, FusedMap{fine});
    EXPECT_FALSE(answer.at("ok").get<bool>());
    EXPECT_EQ(answer.at("exit"), 64);
    EXPECT_EQ(answer.at("error").at("key"), "own_space_m");
}

TEST_F(QueryAnswer, refuses_a_posture_in_which_the_arm_cannot_stand) {
    const auto error = [&](std::vector<double> stands) {
        const Json answer = ask(path({{0.0, 0.0}}), map_, std::move(stands));
        EXPECT_FALSE(answer.contains("configuration")) << "it is none of the path's";
        return answer.value("error", Json());
    };
    EXPECT_TRUE(error({0.0, 0.1}).is_null());
    const Json count = error({0.0});
    EXPECT_EQ(count.at("key"), "the present posture");
    EXPECT_EQ(count.at("value"), "1 positions");
    EXPECT_THAT(count.at("message").get<std::string>(), HasSubstr("2 joints: turn, slide"));
    const Json limits = error({0.0, 0.3});
    EXPECT_EQ(limits.at("code"), "out_of_range");
    EXPECT_EQ(limits.at("key"), "the present posture: slide");
    EXPECT_EQ(limits.at("value"), "0.3");
    EXPECT_THAT(limits.at("message").get<std::string>(), HasSubstr("0 to 0.2"));
}

TEST_F(QueryAnswer, refuses_what_cannot_be_asked_and_says_why) {
    EXPECT_EQ(ask(path({{0.0, 0.0}, {0.0, 0.3}}), map_).at("configuration"), 2);
    const auto error = [&](const QueryRequest& request) {
        const Json answer = ask(request, map_);
        return answer.value("error", Json::object());
    };
    const Json limits = error(path({{0.0, 0.0}, {0.0, 0.3}}));
    EXPECT_EQ(limits.at("key"), "configuration 2: slide");
    EXPECT_EQ(limits.at("value"), "0.3");
    EXPECT_THAT(limits.at("message").get<std::string>(), HasSubstr("0 to 0.2"));
    const Json count = error(path({{0.0}}));
    EXPECT_EQ(count.at("key"), "configuration 1");
    EXPECT_THAT(count.at("message").get<std::string>(), HasSubstr("2 joints: turn, slide"));
    QueryRequest no_link = path({{0.0, 0.0}});
    no_link.links_ignored = {"wrist"};
    const Json no_such_link = error(no_link);
    EXPECT_EQ(no_such_link.at("code"), "unknown_name");
    EXPECT_EQ(no_such_link.at("key"), "links_ignored");
    EXPECT_EQ(no_such_link.at("value"), "'wrist'");
    QueryRequest endless = path({});
    endless.step = 0.005;
    for (int i = 0; i < 60; ++i) endless.path.push_back({i % 2 == 0 ? 3.0 : -3.0, 0.0});
    const Json too_long = error(endless);
    EXPECT_EQ(too_long.at("code"), "limit_exceeded");
    EXPECT_EQ(too_long.at("key"), "path");
    EXPECT_THAT(too_long.at("message").get<std::string>(), HasSubstr("at most 50000 postures"));
}

TEST_F(QueryAnswer, tells_how_old_the_weakest_evidence_is_and_by_what) {
    EXPECT_TRUE(ask(path({{0.0, 0.0}}), map_).at("legs").at(0).at("evidence").is_null())
        << "a map that was never told the time";
    FusedMap map = free_about_origin(30);
    const auto go_on_to = [&](std::int64_t second) { map.advance_time(HostTime{second * 1'000'000'000}); };
    go_on_to(100);
    const Json of_before = ask(path({{0.0, 0.0}}), map);
    EXPECT_EQ(of_before.at("state"), "stale");
    EXPECT_TRUE(of_before.at("legs").at(0).at("evidence").at("age_s").is_null());
    EXPECT_THAT(query_text(of_before), HasSubstr("weakest evidence: of unknown age"));
    confirm_about_origin(map, HostTime{100'000'000'000});
    const auto hand = map.key_of({0.42, 0.02, 0.30}).value();
    go_on_to(105);
    feed(map, std::vector<VoxelUpdate>{{hand, -0.4F}}, SensorKind::camera);
    go_on_to(120);
    const Json young = ask(path({{0.0, 0.0}}), map);
    EXPECT_EQ(young.at("state"), "free");
    EXPECT_EQ(young.at("legs").at(0).at("evidence").at("age_s"), 20);
    EXPECT_EQ(young.at("legs").at(0).at("evidence").at("kind"), "range");
    EXPECT_FALSE(young.at("legs").at(0).at("evidence").at("is_stale").get<bool>());
    go_on_to(131);
    const Json old = ask(path({{0.0, 0.0}}), map);
    EXPECT_EQ(old.at("state"), "stale");
    EXPECT_EQ(old.at("legs").at(0).at("link"), "upper");
    EXPECT_FALSE(old.at("legs").at(0).at("voxel_m").is_null());
    EXPECT_THAT(query_text(old), HasSubstr("stale: upper at ("));
    EXPECT_THAT(query_text(old), HasSubstr("weakest evidence: 31 s old, of a range sensor, at ("));
    QueryRequest own = path({{0.0, 0.0}});
    own.own_space_m = 0.04;
    EXPECT_EQ(ask(own, map).at("state"), "free") << "the arm itself is there, now";
}

TEST_F(QueryAnswer, ends_early_when_it_is_told_to) {
    const Json answer = answer_query(path({{0.0, 0.0}, {1.0, 0.0}}),
                                     {&arm_.rig, &arm_.robot, map_.copy(), {}}, [] { return true; });
    EXPECT_FALSE(answer.at("ok").get<bool>());
    QueryRequest pockets = path({{0.5, 0.0}});
    pockets.kind = QueryKind::pockets;
    int asked = 0;
    const Json unlooked =
        answer_query(pockets, {&arm_.rig, &arm_.robot, map_.copy(), {}}, [&] { return ++asked > 0; });
    EXPECT_FALSE(unlooked.at("ok").get<bool>()) << unlooked;
}

TEST_F(QueryAnswer, lists_pockets_with_a_view_and_the_way_there) {
    const FusedMap holed = without(map_, {0.8, -0.08, 0.24}, {0.96, 0.08, 0.4});
    QueryRequest request = path({{0.5, 0.0}});
    request.kind = QueryKind::pockets;
    request.radius_m = 1.2;
    const Json answer = ask(request, holed);
    ASSERT_TRUE(answer.at("ok").get<bool>()) << answer;
    ASSERT_EQ(answer.at("pockets").size(), 1U);
    const Json& pocket = answer.at("pockets").at(0);
    EXPECT_EQ(pocket.at("voxels"), 64);
    ASSERT_FALSE(pocket.at("view").is_null());
    EXPECT_EQ(pocket.at("view").at("sensor"), "palm");
    EXPECT_EQ(pocket.at("view").at("way"), "free");
    EXPECT_EQ(pocket.at("view").at("free_evidence").at("images"), 2.5);
    request.min_evidence = 3.0;
    const Json weak = ask(request, holed);
    EXPECT_EQ(weak.at("pockets").at(0).at("view").at("way"), "unknown");
    EXPECT_EQ(weak.at("pockets").at(0).at("view").at("state"), "unknown");
    EXPECT_THAT(query_text(answer), HasSubstr("   1  4.10 l about (0.880, 0.000, 0.320) m"));
    EXPECT_TRUE(answer.at("views_not_tried").is_null());
}

TEST_F(QueryAnswer, says_of_a_pocket_without_a_view_whether_any_was_tried) {
    const FusedMap holed = without(map_, {0.8, -0.08, 0.24}, {0.96, 0.08, 0.4});
    QueryRequest request = path({{0.5, 0.0}});
    request.kind = QueryKind::pockets;
    request.radius_m = 1.2;
    const auto reported = [&](const Json& answer) {
        EXPECT_TRUE(answer.at("pockets").at(0).at("view").is_null()) << answer;
        return query_text(answer);
    };
    QueryRequest few = request;
    few.views_tried = 1;  // as it stands, or near: it looks past the pocket
    EXPECT_THAT(reported(ask(few, holed)), HasSubstr("       no view found\n"));
    QueryRequest none = request;
    none.views_tried = 0;
    EXPECT_THAT(reported(ask(none, holed)), HasSubstr("\nno view was tried: no posture was to be tried\n"));
    request.path.clear();
    EXPECT_THAT(reported(ask(request, holed)),
                HasSubstr("\nno view was tried: the arm's posture is unknown: give it as --stands\n"));
    HostRig blind = arm_.rig;
    for (HostNode& node : blind.nodes) node.sensors.clear();
    request.path = {{0.5, 0.0}};
    EXPECT_THAT(reported(answer_query(request, {&blind, &arm_.robot, holed.copy(), {}})),
                HasSubstr("\nno view was tried: the rig has no range sensor\n"));
}

TEST_F(QueryAnswer, takes_own_space_for_free_whatever_range_sensors_counted_there) {
    MappingConfig config = fast_mapping();
    config.map.resolution_m = 0.02;  // some voxels lie wholly within the arm, which is 0.08 m thick
    FusedMap map(config.map);
    constexpr std::array<std::uint16_t, 2> kSides{32704, 32768};
    for (const auto x : kSides) {
        for (const auto y : kSides) {
            for (const auto z : kSides) ASSERT_TRUE(map.set_cube({{x, y, z}, 6}, -1.0F));
        }
    }
    const VoxelKey inside = *map.key_of({0.2, 0.01, 0.31});
    ConeVoxels cone;
    cone.cap = {{inside, 1.0F}};
    cone.middle = {inside};
    FusedMap marked = map.copy();
    confirm(marked, cone, 2.0F);
    for (int i = 0; i < 6; ++i) feed(map, cone, config.cone);
    QueryRequest request = path({{0.0, 0.0}});
    for (const FusedMap* counted : {&map, &marked}) {
        request.own_space_m.reset();
        ASSERT_EQ(ask(request, *counted).at("state"), "occupied");
        request.own_space_m = 0.04;
        EXPECT_EQ(ask(request, *counted).at("state"), "free");
    }
}

TEST_F(QueryAnswer, of_a_daemon_that_does_not_know_how_the_arm_stands_takes_nothing_for_its_own_space) {
    QueryRequest request = path({{0.0, 0.0}});
    request.own_space_m = 0.04;
    const Json answer =
        answer_query(request, {&arm_.rig, &arm_.robot, map_.copy(), {}, nullptr, true}, [] { return false; });
    EXPECT_FALSE(answer.at("ok").get<bool>());
    EXPECT_EQ(answer.at("exit"), static_cast<int>(ExitCode::unavailable));
    EXPECT_EQ(answer.at("error").at("code"), "no_data");
}

TEST_F(QueryAnswer, of_a_leg_that_never_ends_counts_no_more_postures_than_fit_a_number) {
    const auto robot = RobotQuery::build(arm_.rig, arm_.robot);
    ASSERT_TRUE(robot);
    const std::array from{0.0, 0.0};
    const Leg endless(*robot, map_, from, std::array{1e20, 0.0});
    EXPECT_EQ(endless.postures(), std::size_t{1'000'000'000'000'001});
    EXPECT_EQ(Leg(*robot, map_, from, from).postures(), 1U);
}

TEST_F(QueryAnswer, ends_between_two_postures_of_a_leg) {
    int asked = 0;
    const Json answer = answer_query(path({{0.0, 0.0}, {3.0, 0.0}}),
                                     {&arm_.rig, &arm_.robot, map_.copy(), {}}, [&] { return ++asked > 5; });
    EXPECT_FALSE(answer.at("ok").get<bool>());
    EXPECT_LT(asked, 12);
}

}  // namespace
}  // namespace octoskin
