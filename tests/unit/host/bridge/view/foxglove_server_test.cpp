// Channels, subscriptions and services, without a socket.
#include "host/bridge/view/foxglove_server.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "host/bridge/view/view_topics.hpp"
#include "host/io/snapshot/bytes.hpp"
#include "ros_messages.hpp"

namespace octoskin::view {
namespace {

using Json = nlohmann::ordered_json;

/// A binary message of a channel, or the answer of a service.
struct Data {
    std::uint8_t opcode = 0;
    std::uint32_t subscription = 0;
    std::int64_t time = 0;
    std::string payload;
};

Data data_of(const WebMessage& message) {
    snapshot::ByteReader reader(message.head);
    Data data;
    data.opcode = reader.get<std::uint8_t>();
    data.subscription = reader.get<std::uint32_t>();
    data.time = reader.get<std::int64_t>();
    data.payload = message.body ? *message.body : "";
    return data;
}

class FoxgloveServerTest : public ::testing::Test {
  protected:
    FoxgloveServerTest() {
        server.connect({[this](ClientId id) { woken.insert(id); },
                        [this](ClientId id, Refusal why) {
                            dropped.insert(id);
                            server.on_refused(why, "");
                        }});
    }
    ChannelId channel(const std::string& topic, bool is_kept = true) {
        return server.open({.topic = topic, .encoding = "json", .schema_name = "T"}, is_kept);
    }
    /// Everything that waits for a client.
    std::vector<WebMessage> all(ClientId client) {
        std::vector<WebMessage> messages;
        while (auto message = server.next(client)) messages.push_back(std::move(*message));
        return messages;
    }
    /// The texts among them with this `op`.
    std::vector<Json> texts(ClientId client, const std::string& op) {
        std::vector<Json> found;
        for (const WebMessage& message : all(client))
            if (!message.is_binary)
                if (Json text = Json::parse(message.head); text.at("op") == op) found.push_back(text);
        return found;
    }
    std::vector<Data> data(ClientId client) {
        std::vector<Data> found;
        for (const WebMessage& message : all(client))
            if (message.is_binary) found.push_back(data_of(message));
        return found;
    }
    void say(ClientId client, const Json& request) {
        EXPECT_FALSE(server.on_message(client, request.dump(), false));
    }
    void subscribe(ClientId client, std::uint32_t id, ChannelId to) {
        say(client, {{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", to}}}}});
    }
    void call(ClientId client, std::uint32_t service, std::uint32_t number, const std::string& payload,
              const std::string& encoding = "json") {
        std::string bytes;
        snapshot::ByteWriter writer(bytes);
        writer.put(std::uint8_t{2});
        writer.put(service);
        writer.put(number);
        writer.put(static_cast<std::uint32_t>(encoding.size()));
        EXPECT_FALSE(server.on_message(client, bytes + encoding + payload, true));
    }

    std::set<ClientId> woken;
    std::set<ClientId> dropped;
    FoxgloveServer server{{.name = "octoskin", .session = "s"}};
};

TEST_F(FoxgloveServerTest, greets_with_what_it_is_its_channels_and_its_notices) {
    channel("/a");
    server.add_service("/s", "S", [](const std::string&, const Reply&) {});
    server.notify(foxglove::Level::warning, "x", "no daemon");
    server.on_open(1);
    std::vector<std::string> ops;
    for (const WebMessage& message : all(1)) ops.push_back(Json::parse(message.head).at("op"));
    EXPECT_EQ(ops, (std::vector<std::string>{"serverInfo", "advertise", "advertiseServices", "status"}));
}

TEST_F(FoxgloveServerTest, sends_messages_to_their_readers_only) {
    const ChannelId a = channel("/a");
    const ChannelId b = channel("/b");
    for (const ClientId client : {1U, 2U}) server.on_open(client);
    subscribe(1, 70, a);
    subscribe(2, 71, b);
    (void)all(1);
    (void)all(2);
    woken.clear();
    EXPECT_EQ(server.readers(a), 1U);
    server.publish(a, WallTime{5}, "one");
    EXPECT_EQ(woken, std::set<ClientId>{1});
    const auto got = data(1);
    ASSERT_EQ(got.size(), 1U);
    EXPECT_EQ(got[0].opcode, 1);
    EXPECT_EQ(got[0].subscription, 70U);
    EXPECT_EQ(got[0].time, 5);
    EXPECT_EQ(got[0].payload, "one");
    EXPECT_TRUE(data(2).empty());
}

TEST_F(FoxgloveServerTest, keeps_the_newest_for_late_readers_unless_it_is_a_stream) {
    const ChannelId kept = channel("/kept");
    const ChannelId stream = channel("/stream", false);
    for (const ChannelId one : {kept, stream})
        for (const char* const text : {"old", "new"}) server.publish(one, WallTime{1}, text);
    server.on_open(1);
    subscribe(1, 1, kept);
    subscribe(1, 2, stream);
    const auto got = data(1);
    ASSERT_EQ(got.size(), 1U);
    EXPECT_EQ(got[0].payload, "new");
    server.forget_messages(kept);
    server.on_open(2);
    subscribe(2, 1, kept);
    EXPECT_TRUE(data(2).empty());
}

TEST_F(FoxgloveServerTest, gives_a_slow_client_the_newest_and_counts_the_rest) {
    const ChannelId busy = channel("/busy");
    const ChannelId quiet = channel("/quiet");
    server.on_open(1);
    subscribe(1, 1, busy);
    subscribe(1, 2, quiet);
    (void)all(1);
    for (int i = 0; i < 100; ++i) server.publish(busy, WallTime{i}, std::to_string(i));
    server.publish(quiet, WallTime{7}, "quiet");
    const auto got = data(1);
    ASSERT_EQ(got.size(), 2U);
    EXPECT_EQ(got[0].payload, "99");
    EXPECT_EQ(got[1].payload, "quiet");
    server.notify_dropped();
    EXPECT_EQ(server.counts().dropped, 99U);
    const auto notices = texts(1, "status");
    ASSERT_EQ(notices.size(), 1U);
    EXPECT_EQ(notices[0].at("id"), "octoskin.dropped");
    server.notify_dropped();
    EXPECT_TRUE(texts(1, "status").empty()) << "nothing new";
}

TEST_F(FoxgloveServerTest, serves_channels_in_turn) {
    const ChannelId a = channel("/a");
    const ChannelId b = channel("/b");
    server.on_open(1);
    subscribe(1, 1, a);
    subscribe(1, 2, b);
    (void)all(1);
    std::vector<std::uint32_t> order;
    for (int i = 0; i < 4; ++i) {
        server.publish(a, WallTime{1}, "a");
        server.publish(b, WallTime{1}, "b");
        order.push_back(data_of(*server.next(1)).subscription);
    }
    EXPECT_EQ(order, (std::vector<std::uint32_t>{1, 2, 1, 2}));
}

TEST_F(FoxgloveServerTest, keeps_messages_of_several_keys_beside_each_other) {
    const ChannelId joints = channel("/joints");
    server.publish(joints, WallTime{1}, "arm", 0);
    server.publish(joints, WallTime{1}, "hand", 1);
    server.publish(joints, WallTime{2}, "arm again", 0);
    server.on_open(1);
    subscribe(1, 1, joints);
    const auto got = data(1);
    ASSERT_EQ(got.size(), 2U);
    EXPECT_EQ(got[0].payload, "arm again");
    EXPECT_EQ(got[1].payload, "hand");
}

TEST_F(FoxgloveServerTest, counts_readers_that_leave_in_every_way) {
    const ChannelId a = channel("/a");
    for (const ClientId client : {1U, 2U, 3U}) {
        server.on_open(client);
        subscribe(client, 9, a);
    }
    EXPECT_EQ(server.readers(a), 3U);
    say(1, {{"op", "unsubscribe"}, {"subscriptionIds", {9}}});
    EXPECT_EQ(server.readers(a), 2U);
    server.on_close(2);
    EXPECT_EQ(server.readers(a), 1U);
    server.close(a);
    EXPECT_EQ(server.readers(a), 0U);
    const auto gone = texts(3, "unadvertise");
    ASSERT_EQ(gone.size(), 1U);
    EXPECT_EQ(gone[0].at("channelIds"), Json({a}));
    server.publish(a, WallTime{1}, "x");
    EXPECT_TRUE(data(3).empty());
}

TEST_F(FoxgloveServerTest, warns_of_subscriptions_that_cannot_be) {
    const ChannelId a = channel("/a");
    server.on_open(1);
    subscribe(1, 1, a);
    (void)all(1);
    subscribe(1, 2, a);        // again
    subscribe(1, 1, a + 100);  // no such channel
    say(1, {{"op", "unsubscribe"}, {"subscriptionIds", {5}}});
    say(1, {{"op", "getParameters"}});
    EXPECT_EQ(texts(1, "status").size(), 4U);
    EXPECT_EQ(server.readers(a), 1U);
    EXPECT_EQ(server.counts().unsupported, 1U);
}

TEST_F(FoxgloveServerTest, refuses_a_malformed_message) {
    server.on_open(1);
    EXPECT_EQ(server.on_message(1, "{", false), Refusal::malformed);
    EXPECT_EQ(server.on_message(1, "\x09", true), Refusal::malformed);
}

TEST_F(FoxgloveServerTest, answers_calls_later_and_to_the_right_client) {
    std::vector<std::pair<std::string, Reply>> asked;
    server.add_service("/s", "S", [&](std::string request, Reply reply) {
        asked.emplace_back(std::move(request), std::move(reply));
    });
    for (const ClientId client : {1U, 2U}) server.on_open(client);
    call(1, 1, 10, "{ \"a\":\n1 }");
    call(2, 1, 10, "{}");
    ASSERT_EQ(asked.size(), 2U);
    EXPECT_EQ(asked[0].first, R"({"a":1})") << "one line";
    (void)all(1);
    (void)all(2);
    asked[1].second(std::string("two"));
    asked[0].second(unexpected(std::string("no daemon")));
    const auto answered = all(2);
    ASSERT_EQ(answered.size(), 1U);
    EXPECT_EQ(answered[0].head, foxglove::response_head(1, 10, "json"));
    EXPECT_EQ(*answered[0].body, "two");
    const auto failed = texts(1, "serviceCallFailure");
    ASSERT_EQ(failed.size(), 1U);
    EXPECT_EQ(failed[0].at("callId"), 10);
}

TEST_F(FoxgloveServerTest, refuses_calls_that_are_wrong_or_too_many) {
    std::vector<Reply> replies;
    server.add_service("/s", "S",
                       [&](const std::string&, Reply reply) { replies.push_back(std::move(reply)); });
    server.on_open(1);
    (void)all(1);
    call(1, 2, 1, "{}");
    call(1, 1, 2, "{}", "cdr");
    call(1, 1, 3, "[]");
    call(1, 1, 4, "{" + std::string(100'000, ' ') + "}");
    EXPECT_EQ(texts(1, "serviceCallFailure").size(), 4U);
    for (std::uint32_t i = 0; i < 6; ++i) call(1, 1, i, "{}");
    EXPECT_EQ(replies.size(), FoxgloveServer::kCallsMax);
    EXPECT_EQ(texts(1, "serviceCallFailure").size(), 2U);
    EXPECT_EQ(server.counts().refused_calls, 6U);
    replies.front()(std::string("{}"));
    call(1, 1, 9, "{}");
    EXPECT_EQ(replies.size(), FoxgloveServer::kCallsMax + 1);
    server.on_close(1);
    replies.back()(std::string("{}"));  // the client has gone
}

TEST_F(FoxgloveServerTest, drops_a_client_that_asks_and_does_not_read) {
    const std::string large(std::size_t{1} << 20U, 'x');
    server.add_service("/s", "S", [&](const std::string&, const Reply& reply) { reply(large); });
    server.on_open(1);
    for (std::uint32_t i = 0; i < 8; ++i) call(1, 1, i, "{}");
    EXPECT_EQ(dropped, std::set<ClientId>{1});
    EXPECT_GT(server.counts().of(Refusal::stalled), 0U);
}

TEST_F(FoxgloveServerTest, serves_files_one_at_a_time_between_other_messages) {
    std::vector<std::string> read;
    server.serve_assets([&](const std::string& uri) -> Result<std::string, std::string> {
        read.push_back(uri);
        if (uri == "none") return unexpected(std::string("there is none"));
        return std::string(std::size_t{8} << 20U, 'm');  // more than a client's texts may have
    });
    const ChannelId busy = channel("/busy", false);
    server.on_open(1);
    const Json info = Json::parse(server.next(1)->head);
    EXPECT_EQ(info.at("capabilities"), Json::array({"assets"}));
    (void)all(1);
    subscribe(1, 5, busy);
    (void)all(1);
    const auto fetch = [&](const std::string& uri, std::uint32_t request) {
        say(1, {{"op", "fetchAsset"}, {"uri", uri}, {"requestId", request}});
    };
    for (std::uint32_t i = 0; i < 3; ++i) fetch(i == 1 ? "none" : "mesh", i);
    EXPECT_TRUE(read.empty()) << "a file is read when the client is ready for it";
    std::vector<std::uint8_t> opcodes;
    for (int i = 0; i < 5; ++i) {
        server.publish(busy, WallTime{i}, "busy");
        const auto message = server.next(1);
        ASSERT_TRUE(message);
        EXPECT_EQ(read.size(), static_cast<std::size_t>(i / 2 + 1)) << i;
        opcodes.push_back(static_cast<std::uint8_t>(message->head.at(0)));
        if (i == 0) {
            EXPECT_EQ(message->head + message->body->substr(0, 1), foxglove::asset_head(0) + "m");
        }
        if (i == 2) {
            EXPECT_EQ(message->head, foxglove::asset_failure(1, "there is none"));
        }
    }
    EXPECT_EQ(opcodes, (std::vector<std::uint8_t>{4, 1, 4, 1, 4}));
    for (std::uint32_t i = 0; i <= FoxgloveServer::kAssetsMax; ++i) fetch("mesh", i);
    EXPECT_EQ(server.next(1)->head.substr(0, 6), "\x04" + std::string("\0\x01\0\0\x01", 5))
        << "the last one is refused";
    EXPECT_TRUE(dropped.empty());
}

TEST_F(FoxgloveServerTest, has_no_files_unless_it_is_given_some) {
    server.on_open(1);
    say(1, {{"op", "fetchAsset"}, {"uri", "mesh"}, {"requestId", 1}});
    EXPECT_EQ(server.counts().unsupported, 1U);
}

TEST_F(FoxgloveServerTest, shows_a_sentence_once_until_it_changes) {
    server.on_open(1);
    (void)all(1);
    for (const char* const text : {"a", "a", "b", "", ""}) server.notify(foxglove::Level::info, "id", text);
    std::vector<std::string> ops;
    for (const WebMessage& message : all(1)) ops.push_back(Json::parse(message.head).at("op"));
    EXPECT_EQ(ops, (std::vector<std::string>{"status", "status", "removeStatus"}));
}

TEST_F(FoxgloveServerTest, is_a_sink_of_topics_of_ros) {
    ViewTopics topics(server);
    const auto& type = ros::std_msgs::String::kType;
    auto kept = topics.writer("/kept", type, {.durability = ros::Durability::transient_local}).value();
    const auto stream = topics.writer("/stream", type, {}).value();
    EXPECT_TRUE(kept->write({0, 1, 0, 0, 42}, WallTime{3}));
    EXPECT_TRUE(stream->write({0, 1, 0, 0, 43}, WallTime{3}));
    server.on_open(1);
    const auto channels = texts(1, "advertise");
    const Json& one = channels.at(0).at("channels").at(0);
    EXPECT_EQ(one.at("encoding"), "cdr");
    EXPECT_EQ(one.at("schemaEncoding"), "ros2msg");
    EXPECT_EQ(one.at("schemaName"), "std_msgs/msg/String");
    EXPECT_EQ(one.at("schema"), type.definition);
    EXPECT_EQ(kept->readers(), 0U);
    subscribe(1, 1, one.at("id"));
    subscribe(1, 2, channels.at(0).at("channels").at(1).at("id"));
    EXPECT_EQ(kept->readers(), 1U);
    const auto got = data(1);
    ASSERT_EQ(got.size(), 1U);
    EXPECT_EQ(got[0].payload, std::string("\0\1\0\0\52", 5));
    kept.reset();
    EXPECT_EQ(texts(1, "unadvertise").size(), 1U);
}

}  // namespace
}  // namespace octoskin::view
