// Topics of ROS as channels: what the bridge publishes, for clients of Foxglove's protocol.
#pragma once

#include <memory>
#include <string>

#include "host/bridge/topics/topic_sink.hpp"
#include "host/bridge/view/foxglove_server.hpp"

namespace octoskin::view {

class ViewTopics final : public bridge::TopicSink {
  public:
    /// `server` must outlive the writers.
    explicit ViewTopics(FoxgloveServer& server) : server_(server) {}
    /// Never an error. A transient local topic keeps its newest message for late readers, whatever
    /// `qos.keep_last`.
    [[nodiscard]] Result<std::unique_ptr<bridge::TopicWriter>, Error> writer(const std::string& topic,
                                                                             const ros::TypeName& type,
                                                                             const ros::Qos& qos) override;

  private:
    FoxgloveServer& server_;
};

}  // namespace octoskin::view
