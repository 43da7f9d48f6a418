// What DDS discovery tells of the readers and writers of a domain.
#pragma once

#include "tests/ros/endpoints.hpp"

namespace octoskin::ros {

/// Prints an "endpoint" line for each writer and reader of other participants that appears, changes or goes.
class EndpointPrinter : public dds::DomainParticipantListener {
  public:
    void on_publisher_discovery(dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::WriterDiscoveryInfo&& found) override;
    void on_subscriber_discovery(dds::DomainParticipant* participant,
                                 eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& found) override;
};

}  // namespace octoskin::ros
