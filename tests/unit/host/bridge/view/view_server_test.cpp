// What a daemon says, as channels of the view.
#include "host/bridge/view/view_server.hpp"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/bridge/cdr/cdr_reader.hpp"
#include "host/io/snapshot/bytes.hpp"
#include "ros_messages.hpp"

namespace octoskin::view {
namespace {

using Json = nlohmann::ordered_json;

/// A hand on one revolute joint about z, and two cameras.
bridge::RobotFacts robot() {
    bridge::RobotFacts facts;
    facts.rig = "rig";
    facts.root_link = facts.base_link = "base";
    facts.links = {"base", "hand"};
    JointDescription joint{.name = "turn",
                           .parent_link = "base",
                           .child_link = "hand",
                           .kind = JointKind::revolute,
                           .limits = {.min = -2.0, .max = 2.0}};
    joint.T_parent_joint.translation() = Eigen::Vector3d(0.0, 0.0, 0.5);
    facts.joints = {joint};
    facts.joint_sources = {{.is_local = true, .joints = {"turn"}}};
    facts.cameras.resize(2);
    facts.cameras[1].name = "front";
    return facts;
}

class ViewServerTest : public ::testing::Test {
  protected:
    ViewServerTest() {
        server.connect({[](ClientId) {}, [](ClientId, Refusal) {}});
        server.on_open(1);
        view = ViewServer::open(server, "live").value();
    }
    /// The payloads that come on a topic, after `say`. Each topic is subscribed once.
    std::vector<std::string> heard(const std::string& topic) {
        read();
        if (!subscriptions.contains(topic)) {
            const auto id = static_cast<std::uint32_t>(subscriptions.size() + 1);
            subscriptions[topic] = id;
            const Json request = {{"op", "subscribe"},
                                  {"subscriptions", {{{"id", id}, {"channelId", channels.at(topic)}}}}};
            EXPECT_FALSE(server.on_message(1, request.dump(), false));
            read();
        }
        return std::exchange(payloads[subscriptions[topic]], {});
    }
    Json newest(const std::string& topic) {
        const auto all = heard(topic);
        return all.empty() ? Json() : Json::parse(all.back());
    }
    [[nodiscard]] bool has(const std::string& topic) {
        read();
        return channels.contains(topic);
    }
    void read() {
        while (const auto message = server.next(1))
            message->is_binary ? take(*message) : take(Json::parse(message->head));
    }
    void take(const WebMessage& message) {
        snapshot::ByteReader reader(message.head);
        EXPECT_EQ(reader.get<std::uint8_t>(), 1);
        payloads[reader.get<std::uint32_t>()].push_back(*message.body);
    }
    void take(const Json& text) {
        if (text.at("op") == "advertise")
            for (const Json& one : text.at("channels")) channels[one.at("topic")] = one.at("id");
        if (text.at("op") != "unadvertise") return;
        for (const Json& gone : text.at("channelIds"))
            std::erase_if(channels, [&](const auto& one) { return one.second == gone.get<std::uint32_t>(); });
    }

    FoxgloveServer server{{.name = "octoskin", .session = "s"}};
    std::unique_ptr<ViewServer> view;
    std::map<std::string, std::uint32_t> channels;
    std::map<std::string, std::uint32_t> subscriptions;
    std::map<std::uint32_t, std::vector<std::string>> payloads;
};

TEST_F(ViewServerTest, says_whether_a_daemon_is_there) {
    const std::string link = "/octoskin/view/link";
    EXPECT_EQ(newest(link).at("connected"), false);
    view->on_robot(robot());
    EXPECT_EQ(newest(link), Json({{"connected", true}, {"why", ""}, {"mode", "live"}}));
    view->on_lost("gone");
    EXPECT_EQ(newest(link), Json({{"connected", false}, {"why", "gone"}, {"mode", "live"}}));
    view->on_lost("gone");
    EXPECT_TRUE(heard(link).empty()) << "once";
    view->change_place({{"begin_s", 1.5}});
    EXPECT_EQ(newest(link).at("begin_s"), 1.5);
}

TEST_F(ViewServerTest, gives_the_robot_with_its_urdf_once_it_is_known) {
    const std::string topic = "/octoskin/view/robot";
    view->on_described({{"ok", true}, {"rig", "rig"}});
    view->on_robot(robot());
    EXPECT_EQ(newest(topic), Json({{"ok", true}, {"rig", "rig"}, {"urdf", nullptr}}));
    view->on_urdf("<robot/>");
    EXPECT_EQ(newest(topic).at("urdf"), "<robot/>");
    const auto texts = heard("/robot_description");
    ASSERT_EQ(texts.size(), 1U);
    const auto text = cdr::read<ros::std_msgs::String>(cdr::Bytes(texts[0].begin(), texts[0].end()));
    ASSERT_TRUE(text);
    EXPECT_EQ(text->data, "<robot/>");
}

TEST_F(ViewServerTest, gives_joints_by_name_and_the_frames_of_links) {
    view->on_robot(robot());
    (void)heard("/tf");
    (void)heard("/octoskin/view/joints");
    view->on_joints({.source = 0, .position = {0.1}}, HostTime{1});
    view->on_joints({.source = 0, .position = {1.5707963267948966}}, HostTime{2'500'000'000});
    view->on_joints({.source = 9, .position = {1.0}}, HostTime{1});  // of no source of the rig
    view->attend();
    EXPECT_EQ(
        newest("/octoskin/view/joints"),
        Json({{"source", 0}, {"joints", {"turn"}}, {"positions", {1.5707963267948966}}, {"time_s", 2.5}}));
    const auto frames = heard("/tf");
    ASSERT_EQ(frames.size(), 1U);
    const auto message = cdr::read<ros::tf2_msgs::TFMessage>(cdr::Bytes(frames[0].begin(), frames[0].end()));
    ASSERT_TRUE(message);
    ASSERT_EQ(message->transforms.size(), 1U);
    const auto& hand = message->transforms[0];
    EXPECT_EQ(hand.header.frame_id, "base");
    EXPECT_EQ(hand.child_frame_id, "hand");
    EXPECT_NEAR(hand.transform.translation.z, 0.5, 1e-12);
    EXPECT_NEAR(hand.transform.rotation.z, 0.70710678118654752, 1e-12);
    EXPECT_NEAR(hand.transform.rotation.w, 0.70710678118654752, 1e-12);
}

TEST_F(ViewServerTest, gives_readings_together_with_their_times) {
    watch::WatchedRange range;
    range.source.node_id = 3;
    range.range_m = 0.25;
    view->on_range(range, HostTime{77});
    range.range_m.reset();
    view->on_range(range, HostTime{78});
    view->attend();
    const auto batches = heard("/octoskin/view/ranges");
    ASSERT_EQ(batches.size(), 1U);
    std::string_view left = batches[0];
    snapshot::ByteReader base(left);
    EXPECT_EQ(base.get<std::int64_t>(), 0);
    left.remove_prefix(8);
    for (const std::int64_t time : {77, 78}) {
        snapshot::ByteReader head(left);
        const auto bytes = head.get<std::uint32_t>();
        EXPECT_EQ(head.get<std::int64_t>(), time);
        const auto reading = watch::parse_range(left.substr(12, bytes));
        ASSERT_TRUE(reading);
        EXPECT_EQ(reading->source.node_id, 3);
        EXPECT_EQ(reading->range_m.has_value(), time == 77);
        left.remove_prefix(12 + bytes);
    }
    EXPECT_TRUE(left.empty());
}

TEST_F(ViewServerTest, has_a_channel_for_each_cameras_image) {
    view->on_robot(robot());
    EXPECT_TRUE(has("/octoskin/view/images/camera"));
    const watch::WatchedImage image{.camera = 1, .width = 2, .height = 1, .depth_mm = {1000, 0}};
    (void)heard("/octoskin/view/images/front");
    view->on_image(image, HostTime{5});
    EXPECT_EQ(
        heard("/octoskin/view/images/front"),
        std::vector<std::string>{std::string("\x02\x00\x01\x00\x05\0\0\0\0\0\0\0\xe8\x03\x00\x00", 16)});
    view->on_image({.camera = 7, .width = 2, .height = 1, .depth_mm = {1000, 0}}, HostTime{5});
    EXPECT_TRUE(heard("/octoskin/view/images/front").empty());
    auto without = robot();
    without.cameras.pop_back();
    view->on_robot(std::move(without));
    EXPECT_FALSE(has("/octoskin/view/images/front"));
    EXPECT_TRUE(has("/octoskin/view/images/camera"));
}

TEST_F(ViewServerTest, gives_the_status_as_it_is) {
    view->on_status({{"rig", "rig"}, {"problems", Json::array()}});
    EXPECT_EQ(newest("/octoskin/view/status").at("rig"), "rig");
}

}  // namespace
}  // namespace octoskin::view
