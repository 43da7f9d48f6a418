#include "tests/ros/discovery.hpp"

#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

#include <sstream>

#include "tests/ros/output.hpp"

namespace octoskin::ros {
namespace {

using eprosima::fastrtps::rtps::ReaderDiscoveryInfo;
using eprosima::fastrtps::rtps::WriterDiscoveryInfo;

template <typename Value>
std::string text(const Value& value) {
    std::ostringstream stream;
    stream << value;
    return stream.str();
}

std::string durability(dds::DurabilityQosPolicyKind kind) {
    switch (kind) {
        case dds::VOLATILE_DURABILITY_QOS:
            return "volatile";
        case dds::TRANSIENT_LOCAL_DURABILITY_QOS:
            return "transient_local";
        case dds::TRANSIENT_DURABILITY_QOS:
            return "transient";
        case dds::PERSISTENT_DURABILITY_QOS:
            return "persistent";
    }
    return "unknown";
}

/// The value of `key=value;` in a USER_DATA, empty if it is not there.
std::string value_of(const std::string& key, const std::string& user_data) {
    const auto begin = user_data.find(key + "=");
    if (begin == std::string::npos) {
        return "";
    }
    const auto value = begin + key.size() + 1;
    return user_data.substr(value, user_data.find(';', value) - value);
}

/// "rt/joint_states" as "/joint_states"; empty for a topic that is none of ROS 2.
std::string ros_topic(const std::string& topic) {
    return topic.starts_with("rt/") ? topic.substr(2) : "";
}

template <typename Proxy>
Json locators(const Proxy& proxy) {
    Json json = Json::array();
    for (const auto& locator : proxy.remote_locators().unicast) {
        json.push_back(text(locator));
    }
    for (const auto& locator : proxy.remote_locators().multicast) {
        json.push_back(text(locator));
    }
    return json;
}

template <typename Proxy>
Json endpoint(const std::string& kind, const std::string& change, const Proxy& proxy) {
    const auto& bytes = proxy.m_qos.m_userData.data_vec();
    const std::string user_data(bytes.begin(), bytes.end());
    Json representation = Json::array();
    for (const auto id : proxy.m_qos.representation.m_value) {
        representation.push_back(id == dds::XCDR_DATA_REPRESENTATION    ? "XCDR1"
                                 : id == dds::XCDR2_DATA_REPRESENTATION ? "XCDR2"
                                                                        : "XML");
    }
    return {{"event", "endpoint"},
            {"kind", kind},
            {"change", change},
            {"dds_topic", text(proxy.topicName())},
            {"topic", ros_topic(text(proxy.topicName()))},
            {"dds_type", text(proxy.typeName())},
            {"guid", text(proxy.guid())},
            {"reliability",
             proxy.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS ? "reliable" : "best_effort"},
            {"durability", durability(proxy.m_qos.m_durability.kind)},
            {"has_key", proxy.topicKind() == eprosima::fastrtps::rtps::WITH_KEY},
            {"partitions", proxy.m_qos.m_partition.names()},
            {"representation", representation},
            {"has_type_information", proxy.has_type_information()},
            {"user_data", user_data},
            {"type_hash", value_of("typehash", user_data)},
            {"locators", locators(proxy)}};
}

/// Fast DDS tells of the participant's own endpoints, too.
template <typename Proxy>
bool is_of(const dds::DomainParticipant* participant, const Proxy& proxy) {
    return proxy.guid().guidPrefix == participant->guid().guidPrefix;
}

}  // namespace

void EndpointPrinter::on_publisher_discovery(dds::DomainParticipant* own, WriterDiscoveryInfo&& found) {
    if (is_of(own, found.info)) {
        return;
    }
    const std::string change = found.status == WriterDiscoveryInfo::DISCOVERED_WRITER ? "appeared"
                               : found.status == WriterDiscoveryInfo::REMOVED_WRITER  ? "gone"
                                                                                      : "changed";
    print(endpoint("writer", change, found.info));
}

void EndpointPrinter::on_subscriber_discovery(dds::DomainParticipant* own, ReaderDiscoveryInfo&& found) {
    if (is_of(own, found.info)) {
        return;
    }
    const std::string change = found.status == ReaderDiscoveryInfo::DISCOVERED_READER ? "appeared"
                               : found.status == ReaderDiscoveryInfo::REMOVED_READER  ? "gone"
                                                                                      : "changed";
    print(endpoint("reader", change, found.info));
}

}  // namespace octoskin::ros
