#include "host/bridge/view/view_topics.hpp"

#include <utility>

namespace octoskin::view {
namespace {

class ChannelWriter final : public bridge::TopicWriter {
  public:
    ChannelWriter(FoxgloveServer& server, ChannelId channel) : server_(server), channel_(channel) {}
    ~ChannelWriter() override { server_.close(channel_); }
    ChannelWriter(const ChannelWriter&) = delete;
    ChannelWriter& operator=(const ChannelWriter&) = delete;

    [[nodiscard]] bool write(cdr::Bytes message, WallTime when) override {
        server_.publish(channel_, when, std::string(message.begin(), message.end()));
        return true;
    }
    [[nodiscard]] std::uint32_t readers() const override { return server_.readers(channel_); }
    void forget_messages() override { server_.forget_messages(channel_); }

  private:
    FoxgloveServer& server_;
    ChannelId channel_;
};

}  // namespace

Result<std::unique_ptr<bridge::TopicWriter>, Error> ViewTopics::writer(const std::string& topic,
                                                                       const ros::TypeName& type,
                                                                       const ros::Qos& qos) {
    const ChannelId channel = server_.open({.topic = topic,
                                            .encoding = "cdr",
                                            .schema_name = std::string(type.ros),
                                            .schema_encoding = "ros2msg",
                                            .schema = std::string(type.definition)},
                                           qos.durability == ros::Durability::transient_local);
    return std::unique_ptr<bridge::TopicWriter>(std::make_unique<ChannelWriter>(server_, channel));
}

}  // namespace octoskin::view
