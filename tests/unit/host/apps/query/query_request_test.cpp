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
    sent.min_evidence = 2.5;
    const std::string line = to_line(sent);
    EXPECT_TRUE(is_query(line));
    EXPECT_EQ(line.find('\n'), std::string::npos);
    const auto read = read_query(line);
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->kind, QueryKind::postures);
    EXPECT_EQ(read->path, sent.path);
    EXPECT_EQ(read->padding_m, 0.02);
    EXPECT_EQ(read->reach_m, 0.3);
    EXPECT_EQ(read->step, 0.01);
    EXPECT_EQ(read->links_ignored, sent.links_ignored);
    EXPECT_TRUE(read->asks_unmoved_links);
    EXPECT_EQ(read->own_space_m, 0.05);
    EXPECT_EQ(read->min_evidence, 2.5);
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
    sent.min_evidence = 3.0;
    const auto read = read_query(to_line(sent));
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->kind, QueryKind::pockets);
    EXPECT_EQ(read->radius_m, 0.7);
    EXPECT_EQ(read->z_min_m, -0.1);
    EXPECT_EQ(read->pocket_min_m3, 0.002);
    EXPECT_EQ(read->pockets_max, 3U);
    EXPECT_EQ(read->views_tried, 100U);
    EXPECT_EQ(read->min_evidence, 3.0);
    EXPECT_EQ(read->step, 0.02);
}

/// The error of a line that must be refused, as a usage error.
Error refusal(const std::string& line) {
    const auto read = read_query(line);
    EXPECT_FALSE(read) << line;
    if (read) return {};
    EXPECT_EQ(read.error().exit, ExitCode::usage) << line;
    return read.error().error;
}

void expect(const std::string& line, ErrorCode code, const std::string& key, const std::string& value) {
    const Error error = refusal(line);
    EXPECT_EQ(name_of(error.code), name_of(code)) << line;
    EXPECT_EQ(error.key, key) << line;
    EXPECT_EQ(error.value, value) << line;
}

TEST(QueryRequest, is_refused_by_name_of_what_is_wrong_with_it) {
    EXPECT_TRUE(read_query("query {}"));
    for (const char* bare : {"query", "query ", "query   "}) {
        expect(bare, ErrorCode::bad_syntax, "", "");
        EXPECT_THAT(refusal(bare).remedy, HasSubstr("query {}")) << bare;
    }
    expect("query {", ErrorCode::bad_syntax, "", "the end at byte 1");
    EXPECT_THAT(refusal("query {").what, HasSubstr("expected: query {"));
    expect("query [1]", ErrorCode::wrong_type, "", "a list");
    EXPECT_THAT(refusal("query [1]").what, HasSubstr("expected: query {"));
    expect("query {\"paht\": []}", ErrorCode::unknown_key, "paht", "");
    expect("query {\"path\": [0, 1]}", ErrorCode::wrong_type, "path[0]", "0");
    EXPECT_THAT(refusal("query {\"path\": [0, 1]}").what, HasSubstr("such as [[0, -0.785, 1.5]]"));
    expect("query {\"step\": \"0.1\"}", ErrorCode::wrong_type, "step", "\"0.1\"");
    expect("query {\"pockets\": 1}", ErrorCode::wrong_type, "pockets", "1");
    EXPECT_THAT(refusal("query {\"pockets\": 1}").what, HasSubstr("true or false"));
    expect("query {\"links_ignored\": \"hand\"}", ErrorCode::wrong_type, "links_ignored", "\"hand\"");
    EXPECT_THAT(refusal("query {\"links_ignored\": \"hand\"}").what, HasSubstr("[\"gripper\"]"));
    expect("query {\"padding_m\": -1}", ErrorCode::out_of_range, "padding_m", "-1");
    EXPECT_EQ(refusal("query {\"padding_m\": -1}").what, "expected 0 to 1");
    expect("query {\"reach_m\": 1e9}", ErrorCode::out_of_range, "reach_m", "1000000000");
    expect("query {\"step\": 0}", ErrorCode::out_of_range, "step", "0");
    for (const char* number : {"1e300", "-0.5", "2.7", "-1"}) {
        const Error error =
            refusal(std::string("query {\"pockets\": true, \"pockets_max\": ") + number + "}");
        EXPECT_EQ(error.code, ErrorCode::wrong_type);
        EXPECT_EQ(error.key, "pockets_max");
        EXPECT_THAT(error.what, HasSubstr("whole number, 0 or more"));
    }
    expect("query {\"min_evidence\": -1}", ErrorCode::out_of_range, "min_evidence", "-1");
    expect("query {\"min_evidence\": true}", ErrorCode::wrong_type, "min_evidence", "true");
    expect("query {\"own_space_m\": 2}", ErrorCode::out_of_range, "own_space_m", "2");
    expect("query {\"pockets\": true, \"radius_m\": 50}", ErrorCode::out_of_range, "radius_m", "50");
    expect("query {\"pockets\": true, \"views_tried\": 1000000}", ErrorCode::out_of_range, "views_tried",
           "1000000");
}

TEST(QueryRequest, with_what_would_not_be_looked_at_is_refused_by_name) {
    for (const std::string key : {"radius_m", "z_min_m", "pocket_min_m3", "pockets_max", "views_tried"}) {
        const std::string line = "query {\"" + key + "\": 1}";
        expect(line, ErrorCode::conflict, key, "");
        EXPECT_THAT(refusal(line).remedy, HasSubstr("\"pockets\": true"));
        EXPECT_TRUE(read_query("query {\"pockets\": true, \"" + key + "\": 1}")) << key;
    }
    expect(R"(query {"pockets": false, "radius_m": 1})", ErrorCode::conflict, "radius_m", "");
    expect(R"(query {"pockets": true, "reach_m": 1})", ErrorCode::conflict, "reach_m", "");
    expect(R"(query {"pockets": true, "path": [[0], [1]]})", ErrorCode::conflict, "path", "2 configurations");
    EXPECT_TRUE(read_query(R"(query {"pockets": true, "path": [[0]]})"));
    expect(R"(query {"path": []})", ErrorCode::no_content, "path", "");
    EXPECT_THAT(refusal(R"(query {"path": []})").remedy, HasSubstr("leave it out"));
    expect(R"(query {"path": [[0]], "step": 1, "path": [[1]]})", ErrorCode::duplicate, "path", "");
    expect(R"(query {"step": {"a": 1}})", ErrorCode::wrong_type, "step", "an object");
}

TEST(QueryRequest, with_an_unknown_key_is_told_every_key_there_is) {
    const std::string keys = refusal("query {\"x\": 1}").remedy;
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
    const std::string line = "query {\"step\": " + std::string(kDeep, '[') + std::string(kDeep, ']') + "}";
    expect(line, ErrorCode::wrong_type, "step", "a list");
    EXPECT_LT(refusal(line).message().size(), 100U);
}

// As Python's and JavaScript's serializers write them.
TEST(QueryRequest, with_a_number_that_is_none_is_refused_in_our_words) {
    const auto with = [](const std::string& number) { return "query {\"path\": [[" + number + "]]}"; };
    expect(with("null"), ErrorCode::wrong_type, "path[0][0]", "null");
    EXPECT_THAT(refusal(with("null")).what, HasSubstr("expected a list of"));
    expect(with("0, 1], [2, 3], [4, null"), ErrorCode::wrong_type, "path[2][1]", "null");
    expect(with("NaN"), ErrorCode::bad_syntax, "", "\"NaN]]}\" at byte 11");
    EXPECT_THAT(refusal(with("-Infinity")).remedy, HasSubstr("JSON has no NaN and no Infinity"));
    expect(with("1e999"), ErrorCode::out_of_range, "", "");
    for (const char* number : {"null", "NaN", "-Infinity", "1e999", "\"\xff\""})
        EXPECT_THAT(refusal(with(number)).message(), testing::Not(HasSubstr("json.exception"))) << number;
}

TEST(QueryRequest, has_so_many_configurations_and_no_more) {
    QueryRequest request;
    request.path.assign(kConfigurationsMax, {0.0});
    EXPECT_FALSE(fault_of(request));
    request.path.push_back({0.0});
    const auto fault = fault_of(request);
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->code, ErrorCode::limit_exceeded);
    EXPECT_EQ(fault->key, "path");
    EXPECT_EQ(fault->value, "1001 configurations");
    EXPECT_THAT(fault->what, HasSubstr("at most 1000"));
}

}  // namespace
}  // namespace octoskin
