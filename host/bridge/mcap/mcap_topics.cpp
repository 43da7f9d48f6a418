#include "host/bridge/mcap/mcap_topics.hpp"

#include <fmt/format.h>

#include <utility>

namespace octoskin::bridge {

/// Numbers of ROS 2's middleware interface, as in bags of Humble; later versions read them, too.
std::string qos_profiles(const ros::Qos& qos) {
    constexpr int kKeepLast = 1;
    constexpr int kAutomatic = 1;
    constexpr const char* kForever = "{sec: 9223372036, nsec: 854775807}";
    return fmt::format(
        "- history: {}\n  depth: {}\n  reliability: {}\n  durability: {}\n  deadline: {}\n  lifespan: {}\n"
        "  liveliness: {}\n  liveliness_lease_duration: {}\n  avoid_ros_namespace_conventions: false",
        kKeepLast, qos.keep_last, qos.reliability == ros::Reliability::reliable ? 1 : 2,
        qos.durability == ros::Durability::transient_local ? 1 : 2, kForever, kForever, kAutomatic, kForever);
}

class McapTopics::Writer final : public TopicWriter {
  public:
    Writer(McapTopics& topics, std::string topic, std::uint16_t channel)
        : topics_(topics), topic_(std::move(topic)), channel_(channel) {}

    [[nodiscard]] bool write(cdr::Bytes message, WallTime when) override {
        if (!topics_.takes(topic_) || topics_.has_failed_) return false;
        const std::string_view data(reinterpret_cast<const char*>(message.data()), message.size());
        topics_.has_failed_ = !topics_.file_.write(channel_, {std::max<std::int64_t>(when.ns, 0)}, data);
        topics_.counts_.at(topic_).messages += topics_.has_failed_ ? 0 : 1;
        return !topics_.has_failed_;
    }
    [[nodiscard]] std::uint32_t readers() const override { return topics_.takes(topic_) ? 1 : 0; }
    void forget_messages() override {}  // a file keeps what was written

  private:
    McapTopics& topics_;
    std::string topic_;
    std::uint16_t channel_;
};

Result<std::unique_ptr<TopicWriter>, Error> McapTopics::writer(const std::string& topic,
                                                               const ros::TypeName& type,
                                                               const ros::Qos& qos) {
    const auto [place, is_new] = channels_.try_emplace(topic);
    if (is_new) {
        const mcap::Schema schema{std::string(type.ros), "ros2msg", std::string(type.definition)};
        place->second =
            file_.add_channel(schema, {.topic = topic,
                                       .message_encoding = "cdr",
                                       .metadata = {{"offered_qos_profiles", qos_profiles(qos)}}});
        counts_[topic].type = type.ros;
    }
    return std::unique_ptr<TopicWriter>(std::make_unique<Writer>(*this, topic, place->second));
}

}  // namespace octoskin::bridge
