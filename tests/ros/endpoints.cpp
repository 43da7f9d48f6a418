#include "tests/ros/endpoints.hpp"

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <stdexcept>

#include "tests/ros/raw_type.hpp"

namespace octoskin::ros {
namespace {

template <typename Entity>
Entity* made(Entity* entity, const std::string& what) {
    if (entity == nullptr) {
        throw std::runtime_error("Fast DDS makes no " + what);
    }
    return entity;
}

template <typename EndpointQos>
void set(EndpointQos& to, const Qos& qos, const Codec& codec) {
    to.reliability().kind =
        qos.is_reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
    to.durability().kind =
        qos.is_transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
    to.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    to.history().depth = qos.depth;
    to.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    to.data_sharing().off();
    const std::string user_data = "typehash=" + codec.type_hash + ";";
    to.user_data().setValue({user_data.begin(), user_data.end()});
}

}  // namespace

Qos qos_of(const Arguments& arguments) {
    return {arguments.choice("--qos", {"reliable", "best_effort"}) == "reliable",
            arguments.choice("--durability", {"volatile", "transient_local"}) == "transient_local",
            arguments.whole("--depth", 10)};
}

Participant::Participant(int domain, dds::DomainParticipantListener* listener)
    : participant_(made(dds::DomainParticipantFactory::get_instance()->create_participant(
                            static_cast<dds::DomainId_t>(domain), dds::PARTICIPANT_QOS_DEFAULT, listener,
                            dds::StatusMask::none()),
                        "participant")),
      subscriber_(made(participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT), "subscriber")),
      publisher_(made(participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT), "publisher")) {}

Participant::~Participant() {
    participant_->set_listener(nullptr);
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

dds::Topic* Participant::topic_of(const std::string& name, const Codec& codec) {
    const std::string dds_name = "rt" + (name.starts_with("/") ? name : "/" + name);
    if (const auto found = topics_.find(dds_name); found != topics_.end()) {
        if (found->second->get_type_name() != codec.dds_name) {
            throw std::runtime_error(name + " has two types");
        }
        return found->second;
    }
    dds::TypeSupport(new RawType(codec)).register_type(participant_);
    auto* const topic = made(participant_->create_topic(dds_name, codec.dds_name, dds::TOPIC_QOS_DEFAULT),
                             "topic " + dds_name);
    topics_[dds_name] = topic;
    return topic;
}

dds::DataReader* Participant::add_reader(const std::string& topic, const Codec& codec, const Qos& qos,
                                         dds::DataReaderListener* listener) {
    dds::DataReaderQos reader_qos = subscriber_->get_default_datareader_qos();
    set(reader_qos, qos, codec);
    return made(subscriber_->create_datareader(topic_of(topic, codec), reader_qos, listener,
                                               dds::StatusMask::subscription_matched()),
                "reader of " + topic);
}

dds::DataWriter* Participant::add_writer(const std::string& topic, const Codec& codec, const Qos& qos) {
    dds::DataWriterQos writer_qos = publisher_->get_default_datawriter_qos();
    set(writer_qos, qos, codec);
    return made(publisher_->create_datawriter(topic_of(topic, codec), writer_qos), "writer of " + topic);
}

}  // namespace octoskin::ros
