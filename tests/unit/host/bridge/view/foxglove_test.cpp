// Foxglove's protocol: its bytes, literally, and requests that are no requests.
#include "host/bridge/view/foxglove.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "tests/support/cases.hpp"

namespace octoskin::foxglove {
namespace {

using Json = nlohmann::ordered_json;
using namespace std::string_literals;

std::string opened(int levels) {
    return R"({"op":)" + std::string(static_cast<std::size_t>(levels), '[');
}

Fault fault_of(const Result<Request, Fault>& parsed) {
    return parsed ? Fault{255} : parsed.error();
}

TEST(Foxglove, has_a_message_head_of_13_bytes) {
    EXPECT_EQ(message_head(0x01020304, WallTime{0x1112131415161718}),
              "\x01\x04\x03\x02\x01\x18\x17\x16\x15\x14\x13\x12\x11"s);
}

TEST(Foxglove, has_a_response_head_with_the_encoding) {
    EXPECT_EQ(response_head(7, 0x0a0b0c0d, "json"),
              "\x03\x07\x00\x00\x00\x0d\x0c\x0b\x0a\x04\x00\x00\x00json"s);
}

TEST(Foxglove, says_what_it_is) {
    EXPECT_EQ(server_info_text({.name = "octoskin",
                                .capabilities = {"services"},
                                .encodings = {"json"},
                                .metadata = {{"mode", "live"}},
                                .session = "1-2"}),
              R"({"op":"serverInfo","name":"octoskin","capabilities":["services"],"supportedEncodings":)"
              R"(["json"],"metadata":{"mode":"live"},"sessionId":"1-2"})");
}

TEST(Foxglove, advertises_channels_and_takes_them_back) {
    const ChannelInfo channel{3, "/tf", "cdr", "tf2_msgs/msg/TFMessage", "ros2msg", "A a"};
    EXPECT_EQ(advertise_text(std::span(&channel, 1)),
              R"({"op":"advertise","channels":[{"id":3,"topic":"/tf","encoding":"cdr","schemaName":)"
              R"("tf2_msgs/msg/TFMessage","schema":"A a","schemaEncoding":"ros2msg"}]})");
    const std::uint32_t id = 3;
    EXPECT_EQ(unadvertise_text(std::span(&id, 1)), R"({"op":"unadvertise","channelIds":[3]})");
}

TEST(Foxglove, advertises_services_with_schemas_of_both_directions) {
    const ServiceInfo service{1, "/octoskin/query", "octoskin.Query"};
    const Json text = Json::parse(advertise_services_text(std::span(&service, 1)));
    const Json& one = text.at("services").at(0);
    EXPECT_EQ(one.at("name"), "/octoskin/query");
    for (const char* const way : {"request", "response"}) {
        EXPECT_EQ(one.at(way).at("encoding"), "json");
        EXPECT_EQ(Json::parse(one.at(way).at("schema").get<std::string>()).at("type"), "object");
    }
}

TEST(Foxglove, has_status_messages_and_failures) {
    EXPECT_EQ(status_text(Level::warning, "a", "b"), R"({"op":"status","level":1,"message":"b","id":"a"})");
    EXPECT_EQ(remove_status_text("a"), R"({"op":"removeStatus","statusIds":["a"]})");
    EXPECT_EQ(call_failure_text(1, 2, "no"),
              R"({"op":"serviceCallFailure","serviceId":1,"callId":2,"message":"no"})");
}

TEST(Foxglove, says_names_that_are_no_utf8_as_json) {
    const ChannelInfo channel{1, "/\xff", "cdr", "", "", ""};
    EXPECT_FALSE(Json::parse(advertise_text(std::span(&channel, 1)), nullptr, false).is_discarded());
}

TEST(Foxglove, takes_subscriptions) {
    const auto parsed = parse_text(
        R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":5},{"id":4294967295,"channelId":6}]})");
    ASSERT_TRUE(parsed);
    EXPECT_EQ(std::get<Subscribe>(*parsed).subscriptions,
              (std::vector<Subscription>{{0, 5}, {4'294'967'295, 6}}));
    const auto ended = parse_text(R"({"op":"unsubscribe","subscriptionIds":[1,2]})");
    ASSERT_TRUE(ended);
    EXPECT_EQ(std::get<Unsubscribe>(*ended).subscriptions, (std::vector<std::uint32_t>{1, 2}));
}

TEST(Foxglove, takes_calls) {
    const auto parsed = parse_binary("\x02\x07\0\0\0\x01\0\0\0\x04\0\0\0json{}"s);
    ASSERT_TRUE(parsed);
    const auto& call = std::get<ServiceCall>(*parsed);
    EXPECT_EQ(call.service, 7U);
    EXPECT_EQ(call.call, 1U);
    EXPECT_EQ(call.encoding, "json");
    EXPECT_EQ(call.payload, "{}");
}

TEST(Foxglove, takes_requests_for_files_and_answers_them) {
    const auto asked = std::get<FetchAsset>(
        *parse_text(R"({"op":"fetchAsset","uri":"package://arm/a.stl","requestId":258})"));
    EXPECT_EQ(asked.uri, "package://arm/a.stl");
    EXPECT_EQ(asked.request, 258U);
    EXPECT_EQ(asset_head(258), "\x04\x02\x01\0\0\0\0\0\0\0"s);
    EXPECT_EQ(asset_failure(258, "none"), "\x04\x02\x01\0\0\x01\x04\0\0\0none"s);
    const auto with = [](const std::string& members) {
        return fault_of(parse_text(R"({"op":"fetchAsset")" + members + "}"));
    };
    EXPECT_EQ(with(R"(,"uri":"package://arm/a.stl")"), Fault::bad_member);
    EXPECT_EQ(with(R"(,"requestId":1,"uri":7)"), Fault::bad_member);
    EXPECT_EQ(with(R"(,"requestId":-1,"uri":"a")"), Fault::bad_member);
    EXPECT_EQ(with(R"(,"requestId":1,"uri":")" + std::string(kUriMax + 1, 'a') + '"'), Fault::too_many);
}

TEST(Foxglove, names_operations_that_it_does_not_have) {
    EXPECT_EQ(std::get<Unsupported>(*parse_text(R"({"op":"getParameters"})")).operation, "getParameters");
    EXPECT_EQ(std::get<Unsupported>(*parse_binary("\x01\0\0\0\0"s)).operation, "message");
    const std::string endless = R"({"op":")" + std::string(5000, 'x') + "\"}";
    EXPECT_EQ(std::get<Unsupported>(*parse_text(endless)).operation.size(), 64U);
}

TEST(Foxglove, refuses_what_is_no_request) {
    EXPECT_EQ(fault_of(parse_text("")), Fault::no_json);
    EXPECT_EQ(fault_of(parse_text("{\"op\":\"\xff\"}")), Fault::no_json);
    EXPECT_EQ(fault_of(parse_text(opened(100'000))), Fault::no_json);
    EXPECT_EQ(fault_of(parse_text("[]")), Fault::no_operation);
    EXPECT_EQ(fault_of(parse_text(R"({"op":1})")), Fault::no_operation);
    EXPECT_EQ(fault_of(parse_text(R"({"op":"subscribe"})")), Fault::bad_member);
    for (const char* const id : {"-1", "1.5", "4294967296", "\"1\"", "null"}) {
        const std::string number(id);
        EXPECT_EQ(fault_of(parse_text(R"({"op":"subscribe","subscriptions":[{"id":)" + number +
                                      R"(,"channelId":1}]})")),
                  Fault::bad_member)
            << id;
        EXPECT_EQ(fault_of(parse_text(R"({"op":"unsubscribe","subscriptionIds":[)" + number + "]}")),
                  Fault::bad_member)
            << id;
    }
}

TEST(Foxglove, bounds_lists) {
    const auto list_of = [](std::size_t entries) {
        Json list = Json::array();
        for (std::size_t i = 0; i < entries; ++i) list.push_back(i);
        return Json{{"op", "unsubscribe"}, {"subscriptionIds", list}}.dump();
    };
    EXPECT_TRUE(parse_text(list_of(kListMax)));
    EXPECT_EQ(fault_of(parse_text(list_of(kListMax + 1))), Fault::too_many);
}

TEST(Foxglove, refuses_every_cut_of_a_call_and_lengths_beyond_its_end) {
    const std::string whole = "\x02\x07\0\0\0\x01\0\0\0\x04\0\0\0json"s;
    for (std::size_t bytes = 0; bytes < whole.size(); ++bytes)
        EXPECT_EQ(fault_of(parse_binary(whole.substr(0, bytes))), Fault::truncated) << bytes;
    EXPECT_TRUE(parse_binary(whole));
    EXPECT_EQ(fault_of(parse_binary("\x02\x07\0\0\0\x01\0\0\0\xff\xff\xff\xffjson"s)), Fault::truncated);
    for (int opcode = 0; opcode < 256; ++opcode) {
        if (opcode == 1 || opcode == 2) continue;
        EXPECT_EQ(fault_of(parse_binary(std::string(1, static_cast<char>(opcode)))), Fault::bad_opcode);
    }
}

// Bytes changed, left out and doubled in real requests.
TEST(Foxglove, survives_a_hundred_thousand_changed_requests) {
    const std::vector<std::string> seeds = {
        R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":5},{"id":1,"channelId":6}]})",
        R"({"op":"fetchAsset","uri":"package://arm/a.stl","requestId":3})",
        R"({"op":"unsubscribe","subscriptionIds":[1,2]})", R"({"op":"getParameters","parameterNames":[]})",
        "\x02\x07\0\0\0\x01\0\0\0\x04\0\0\0json{\"point_m\":[0,0,0]}"s};
    std::mt19937 random(11);
    unsigned taken = 0;
    const unsigned count = testing_support::cases(100'000);
    for (unsigned i = 0; i < count; ++i) {
        std::string bytes = seeds[random() % seeds.size()];
        for (unsigned change = random() % 4; change > 0; --change) {
            const std::size_t place = random() % bytes.size();
            if (random() % 3 == 0) bytes.erase(place, 1 + random() % 5);
            if (bytes.empty()) bytes = "{";
            bytes[random() % bytes.size()] = static_cast<char>(random());
        }
        taken += parse_text(bytes) ? 1U : 0U;
        taken += parse_binary(bytes) ? 1U : 0U;
    }
    EXPECT_GT(taken, count / 10);
    EXPECT_LT(taken, count);
}

}  // namespace
}  // namespace octoskin::foxglove
