// The network of a ROS 2 node, from the environment.
#include "host/bridge/dds/network.hpp"

#include <gtest/gtest.h>

#include <map>

namespace octoskin::dds {
namespace {

using Variables = std::map<std::string, std::string>;

Result<Network, Error> of(const Variables& variables, bool this_machine_only = false) {
    return network_of(
        [&variables](const char* name) {
            const auto found = variables.find(name);
            return found == variables.end() ? std::nullopt : std::optional(found->second);
        },
        this_machine_only);
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(Network, is_the_subnet_in_domain_0_by_default) {
    const Network network = of({}).value();
    EXPECT_EQ(network.domain, 0U);
    EXPECT_FALSE(network.is_local_only);
    EXPECT_FALSE(has(network.configuration, "Interfaces"));
    EXPECT_FALSE(has(network.configuration, "AllowMulticast"));
    EXPECT_FALSE(has(network.configuration, "Peer"));
}

TEST(Network, has_the_domain_of_the_environment) {
    EXPECT_EQ(of({{"ROS_DOMAIN_ID", "42"}}).value().domain, 42U);
    EXPECT_EQ(of({{"ROS_DOMAIN_ID", ""}}).value().domain, 0U);
    for (const char* const wrong : {"233", "-1", "4x", "ten"}) {
        const auto refused = of({{"ROS_DOMAIN_ID", wrong}});
        ASSERT_FALSE(refused) << wrong;
        EXPECT_TRUE(has(refused.error().message(), "ROS_DOMAIN_ID")) << refused.error().message();
    }
}

TEST(Network, is_loopback_if_a_node_would_be_there) {
    for (const Variables& variables : {Variables{{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}},
                                       Variables{{"ROS_LOCALHOST_ONLY", "1"}}}) {
        const Network network = of(variables).value();
        EXPECT_TRUE(has(network.configuration, "address=\"127.0.0.1\""));
        EXPECT_TRUE(has(network.configuration, "<ParticipantIndex>auto"));
        EXPECT_TRUE(has(network.configuration, "<Peer address=\"localhost\"/>"));
    }
    const Variables both = {{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}, {"ROS_LOCALHOST_ONLY", "1"}};
    EXPECT_FALSE(has(of(both).value().configuration, "127.0.0.1")) << "the newer variable wins";
    EXPECT_FALSE(of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "subnet"}}));
}

TEST(Network, has_static_peers) {
    const Network network = of({{"ROS_STATIC_PEERS", "192.168.0.7;;robot.local"}}).value();
    EXPECT_TRUE(has(network.configuration, "<Peer address=\"192.168.0.7\"/><Peer address=\"robot.local\"/>"));
    EXPECT_FALSE(of({{"ROS_STATIC_PEERS", "a\"/><Evil/>"}})) << "nothing else gets into the configuration";
    EXPECT_TRUE(
        has(of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}, {"ROS_STATIC_PEERS", "h"}}).value().configuration,
            "<AllowMulticast>false"));
}

TEST(Network, is_that_of_cyclone_dds_if_it_is_configured) {
    const Variables own = {
        {"CYCLONEDDS_URI", "file:///etc/cyclone.xml"}, {"ROS_LOCALHOST_ONLY", "1"}, {"ROS_DOMAIN_ID", "3"}};
    EXPECT_TRUE(of(own).value().configuration.empty());
    EXPECT_EQ(of(own).value().domain, 3U);
    EXPECT_TRUE(of(own, true).value().is_local_only) << "but the option wins";
    EXPECT_TRUE(has(of(own, true).value().configuration, "<MulticastTimeToLive>0"));
}

}  // namespace
}  // namespace octoskin::dds
