#include "host/apps/query/query_request.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace octoskin {
namespace {

using testing::HasSubstr;

TEST(QueryRequest, of_a_path_comes_back_as_it_was_sent) {
    QueryRequest sent;
    sent.path = {{0.1, -0.785}, {1e-9, 2.0 / 3.0}};
    sent.padding_m = 0.02;
    sent.reach_m = 0.3;
    sent.step = 0.01;
    sent.links_ignored = {"gripper \"left\""};
    sent.asks_unmoved_links = true;
    sent.own_space_m = 0.05;
    const std::string line = to_line(sent);
    EXPECT_TRUE(is_query(line));
    EXPECT_EQ(line.find('\n'), std::string::npos);
    const auto read = read_query(line);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->kind, QueryKind::postures);
    EXPECT_EQ(read->path, sent.path);
    EXPECT_EQ(read->padding_m, 0.02);
    EXPECT_EQ(read->reach_m, 0.3);
    EXPECT_EQ(read->step, 0.01);
    EXPECT_EQ(read->links_ignored, sent.links_ignored);
    EXPECT_TRUE(read->asks_unmoved_links);
    EXPECT_EQ(read->own_space_m, 0.05);
}

TEST(QueryRequest, for_pockets_comes_back_as_it_was_sent) {
    QueryRequest sent;
    sent.kind = QueryKind::pockets;
    sent.radius_m = 0.7;
    sent.z_min_m = -0.1;
    sent.pocket_min_m3 = 0.002;
    sent.pockets_max = 3;
    sent.views_tried = 100;
    sent.step = 0.02;  // of the way to a view
    const auto read = read_query(to_line(sent));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->kind, QueryKind::pockets);
    EXPECT_EQ(read->radius_m, 0.7);
    EXPECT_EQ(read->z_min_m, -0.1);
    EXPECT_EQ(read->pocket_min_m3, 0.002);
    EXPECT_EQ(read->pockets_max, 3U);
    EXPECT_EQ(read->views_tried, 100U);
    EXPECT_EQ(read->step, 0.02);
}

TEST(QueryRequest, is_refused_by_name_of_what_is_wrong_with_it) {
    const auto fault = [](const std::string& line) {
        const auto read = read_query(line);
        return read ? std::string("taken") : read.error().message;
    };
    EXPECT_EQ(fault("query {}"), "taken");
    for (const char* bare : {"query", "query ", "query   "})
        EXPECT_THAT(fault(bare), HasSubstr("query expects an object: query {} is about the arm")) << bare;
    EXPECT_THAT(fault("query {"), HasSubstr("invalid JSON from byte 1 (its end); expected: query {"));
    EXPECT_THAT(fault("query [1]"), HasSubstr("expected: query {"));
    EXPECT_THAT(fault("query {\"paht\": []}"),
                HasSubstr("unknown key \"paht\"; the keys are path, padding_m,"));
    EXPECT_EQ(fault("query {\"path\": [0, 1]}"),
              "query: configuration 1 of path is 0; expected a list of joint configurations, each a list "
              "of finite numbers, "
              "such as [[0, -0.785, 1.5]]");
    EXPECT_EQ(fault("query {\"step\": \"0.1\"}"), "query: step is \"0.1\"; expected a number");
    EXPECT_EQ(fault("query {\"pockets\": 1}"), "query: pockets is 1; expected true or false");
    EXPECT_EQ(fault("query {\"links_ignored\": \"hand\"}"),
              "query: links_ignored is \"hand\"; expected a list of names, such as [\"gripper\"]");
    EXPECT_THAT(fault("query {\"padding_m\": -1}"), HasSubstr("padding_m is -1; expected 0 to 1"));
    EXPECT_THAT(fault("query {\"reach_m\": 1e9}"), HasSubstr("reach_m is"));
    EXPECT_THAT(fault("query {\"step\": 0}"), HasSubstr("step is 0"));
    for (const char* number : {"1e300", "-0.5", "2.7", "-1"}) {
        EXPECT_THAT(fault(std::string("query {\"pockets\": true, \"pockets_max\": ") + number + "}"),
                    HasSubstr("; expected a whole number, 0 or more"));
    }
    EXPECT_THAT(fault("query {\"own_space_m\": 2}"), HasSubstr("own_space_m is 2"));
    EXPECT_THAT(fault("query {\"pockets\": true, \"radius_m\": 50}"), HasSubstr("radius_m is 50"));
    EXPECT_THAT(fault("query {\"pockets\": true, \"views_tried\": 1000000}"), HasSubstr("views_tried is"));
}

TEST(QueryRequest, with_what_would_not_be_looked_at_is_refused_by_name) {
    const auto fault = [](const std::string& request) {
        const auto read = read_query("query " + request);
        return read ? std::string("taken") : read.error().message;
    };
    for (const std::string key : {"radius_m", "z_min_m", "pocket_min_m3", "pockets_max", "views_tried"}) {
        EXPECT_EQ(fault("{\"" + key + "\": 1}"),
                  "query: " + key +
                      " has no effect without \"pockets\": true: give that, too, "
                      "or leave it out");
        EXPECT_EQ(fault("{\"pockets\": true, \"" + key + "\": 1}"), "taken");
    }
    EXPECT_THAT(fault(R"({"pockets": false, "radius_m": 1})"), HasSubstr("radius_m has no effect without"));
    EXPECT_THAT(fault(R"({"pockets": true, "reach_m": 1})"),
                HasSubstr("reach_m has no effect in a query about pockets"));
    EXPECT_THAT(fault(R"({"pockets": true, "path": [[0], [1]]})"), HasSubstr("path has 2 configurations"));
    EXPECT_EQ(fault(R"({"pockets": true, "path": [[0]]})"), "taken");
    EXPECT_THAT(fault(R"({"path": []})"), HasSubstr("path is empty; leave it out"));
    EXPECT_EQ(fault(R"({"path": [[0]], "step": 1, "path": [[1]]})"), "query: the key \"path\" comes twice");
    EXPECT_THAT(fault(R"({"step": {"a": 1}})"), HasSubstr("step is an object; expected a number"));
}

TEST(QueryRequest, with_an_unknown_key_is_told_every_key_there_is) {
    const std::string keys = read_query("query {\"x\": 1}").error().message;
    QueryRequest request;
    request.own_space_m = 0.1;
    request.path = {{0.0}};
    for (const QueryKind kind : {QueryKind::postures, QueryKind::pockets}) {
        request.kind = kind;
        request.z_min_m = 0.0;
        const auto sent = nlohmann::json::parse(to_line(request).substr(6));
        for (const auto& [key, value] : sent.items()) EXPECT_THAT(keys, HasSubstr(key));
    }
}

TEST(QueryRequest, is_what_begins_with_the_word_and_no_other) {
    EXPECT_TRUE(is_query("query"));
    EXPECT_TRUE(is_query("query {}"));
    EXPECT_FALSE(is_query("queryall"));
    EXPECT_FALSE(is_query("quer"));
}

// Written out it would take as many calls as it has bytes.
TEST(QueryRequest, with_lists_within_lists_is_refused_in_a_few_words) {
    constexpr std::size_t kDeep = 20'000;
    const auto read =
        read_query("query {\"step\": " + std::string(kDeep, '[') + std::string(kDeep, ']') + "}");
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().message, "query: step is a list; expected a number");
}

// As Python's and JavaScript's serializers write them.
TEST(QueryRequest, with_a_number_that_is_none_is_refused_in_our_words) {
    const auto fault = [](const std::string& number) {
        const auto read = read_query("query {\"path\": [[" + number + "]]}");
        return read ? std::string("taken") : read.error().message;
    };
    EXPECT_THAT(fault("null"), HasSubstr("number 1 of configuration 1 of path is null; expected a list of"));
    EXPECT_THAT(fault("0, 1], [2, 3], [4, null"), HasSubstr("number 2 of configuration 3 of path is null"));
    EXPECT_THAT(fault("NaN"), HasSubstr("invalid JSON from byte 11 (\"NaN]]}\")"));
    EXPECT_THAT(fault("-Infinity"), HasSubstr("JSON has no NaN and no Infinity"));
    EXPECT_THAT(fault("1e999"), HasSubstr("a number is too large"));
    for (const char* number : {"null", "NaN", "-Infinity", "1e999", "\"\xff\""})
        EXPECT_THAT(fault(number), testing::Not(HasSubstr("json.exception"))) << number;
}

TEST(QueryRequest, has_so_many_configurations_and_no_more) {
    QueryRequest request;
    request.path.assign(kConfigurationsMax, {0.0});
    EXPECT_EQ(fault_of(request), "");
    request.path.push_back({0.0});
    EXPECT_THAT(fault_of(request), HasSubstr("1001 configurations; at most 1000"));
}

}  // namespace
}  // namespace octoskin
