// Participant, readers and writers of Fast DDS in its default configuration, with the settings that ROS 2's
// default middleware, rmw_fastrtps, makes: topic `rt/name`, no key, the type hash in USER_DATA, history as
// large as a sample needs, data sharing off.
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <map>
#include <string>

#include "tests/ros/arguments.hpp"
#include "tests/ros/codec.hpp"

namespace octoskin::ros {

namespace dds = eprosima::fastdds::dds;

struct Qos {
    bool is_reliable = true;
    bool is_transient_local = false;
    int depth = 10;  ///< Samples kept.
};

/// From --qos, --durability and --depth.
[[nodiscard]] Qos qos_of(const Arguments& arguments);

class Participant {
  public:
    /// Throws std::runtime_error if Fast DDS makes none.
    explicit Participant(int domain, dds::DomainParticipantListener* listener = nullptr);
    ~Participant();
    Participant(const Participant&) = delete;
    Participant& operator=(const Participant&) = delete;

    /// `topic` is a ROS name, "/joint_states". The listener is told of matched endpoints. Throws
    /// std::runtime_error if Fast DDS refuses, for example a second type for a topic.
    dds::DataReader* add_reader(const std::string& topic, const Codec& codec, const Qos& qos,
                                dds::DataReaderListener* listener);
    dds::DataWriter* add_writer(const std::string& topic, const Codec& codec, const Qos& qos);

  private:
    dds::Topic* topic_of(const std::string& name, const Codec& codec);

    dds::DomainParticipant* participant_;
    dds::Subscriber* subscriber_;
    dds::Publisher* publisher_;
    std::map<std::string, dds::Topic*> topics_;
};

}  // namespace octoskin::ros
