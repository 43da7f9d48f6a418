// A DDS type whose samples are bytes, so that a sample arrives even if its bytes are no message.
#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>

#include "tests/ros/codec.hpp"

namespace octoskin::ros {

/// The sample is Bytes, with the encapsulation.
class RawType : public eprosima::fastdds::dds::TopicDataType {
  public:
    using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

    explicit RawType(const Codec& codec);

    bool serialize(void* sample, Payload* payload) override;
    bool deserialize(Payload* payload, void* sample) override;
    std::function<std::uint32_t()> getSerializedSizeProvider(void* sample) override;
    void* createData() override { return new Bytes(); }
    void deleteData(void* sample) override { delete static_cast<Bytes*>(sample); }
    bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace octoskin::ros
