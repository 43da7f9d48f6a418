// The topics of a DDS participant as a sink of messages.
#pragma once

#include <memory>
#include <string>

#include "host/bridge/dds/participant.hpp"
#include "host/bridge/topics/topic_sink.hpp"

namespace octoskin::dds {

class Topics final : public bridge::TopicSink {
  public:
    /// `participant` must outlive this.
    explicit Topics(const Participant& participant) : participant_(participant) {}
    /// The error names the topic.
    [[nodiscard]] Result<std::unique_ptr<bridge::TopicWriter>, Error> writer(const std::string& topic,
                                                                             const ros::TypeName& type,
                                                                             const ros::Qos& qos) override;

  private:
    const Participant& participant_;
};

}  // namespace octoskin::dds
