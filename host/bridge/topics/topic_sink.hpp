// Where messages of topics go: to DDS, to the clients of a view, or into a file.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/bridge/cdr/cdr_writer.hpp"
#include "host/bridge/messages/qos.hpp"
#include "host/bridge/messages/type_name.hpp"
#include "host/errors/error.hpp"

namespace octoskin::bridge {

/// One topic of a sink; closed with this object.
class TopicWriter {
  public:
    virtual ~TopicWriter() = default;
    /// Takes a message, encoded by cdr::write; `when`: the time of its content. Does not wait for a reader:
    /// the message replaces one that waits. False: it was refused. Throws std::bad_alloc.
    [[nodiscard]] virtual bool write(cdr::Bytes message, WallTime when) = 0;
    /// Number of readers that get the messages: without one, none need be made.
    [[nodiscard]] virtual std::uint32_t readers() const = 0;
    /// A late reader gets none of the messages written so far.
    virtual void forget_messages() = 0;
};

class TopicSink {
  public:
    virtual ~TopicSink() = default;
    /// `topic`: of ROS, beginning with "/". The writer must not outlive the sink.
    [[nodiscard]] virtual Result<std::unique_ptr<TopicWriter>, Error> writer(const std::string& topic,
                                                                             const ros::TypeName& type,
                                                                             const ros::Qos& qos) = 0;
};

}  // namespace octoskin::bridge
