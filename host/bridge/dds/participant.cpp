#include "host/bridge/dds/participant.hpp"

#include <fmt/format.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "host/bridge/dds/local_packets.hpp"
#include "host/bridge/dds/raw_type.hpp"

namespace octoskin::dds {
namespace {

/// Others beyond these are not looked at.
constexpr std::size_t kOthersMax = 4096;

Error cyclone_error(const std::string& what, dds_return_t code) {
    return {.code = ErrorCode::system_error, .what = fmt::format("{}: {}", what, dds_strretcode(-code))};
}

using QosPointer = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

/// As the middlewares of ROS 2 set it: XCDR1, the type's hash in the user data.
QosPointer qos_of(const Qos& qos, const ros::TypeName& type) {
    QosPointer made(dds_create_qos(), &dds_delete_qos);
    constexpr dds_duration_t kBlockingMax = 100'000'000;
    dds_qset_reliability(
        made.get(),
        qos.reliability == Reliability::reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
        kBlockingMax);
    dds_qset_durability(made.get(), qos.durability == Durability::transient_local
                                        ? DDS_DURABILITY_TRANSIENT_LOCAL
                                        : DDS_DURABILITY_VOLATILE);
    dds_qset_history(made.get(), DDS_HISTORY_KEEP_LAST, qos.keep_last);
    const dds_data_representation_id_t representation = DDS_DATA_REPRESENTATION_XCDR1;
    dds_qset_data_representation(made.get(), 1, &representation);
    const std::string hash = fmt::format("typehash={};", type.type_hash);
    dds_qset_userdata(made.get(), hash.data(), hash.size());
    return made;
}

using ListenerPointer = std::unique_ptr<dds_listener_t, decltype(&dds_delete_listener)>;
ListenerPointer listener_of(dds_on_data_available_fn call, void* argument) {
    ListenerPointer made(dds_create_listener(argument), &dds_delete_listener);
    dds_lset_data_available(made.get(), call);
    return made;
}

/// Reads all living samples of a built-in topic.
template <class T, class Use>
void for_each_sample(dds_entity_t reader, Use use) {
    std::vector<void*> all(kOthersMax, nullptr);
    std::vector<dds_sample_info_t> infos(all.size());
    const dds_return_t count =
        dds_read_mask(reader, all.data(), infos.data(), all.size(), static_cast<std::uint32_t>(all.size()),
                      DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE);
    for (dds_return_t i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (infos[at].valid_data) use(*static_cast<const T*>(all[at]));
    }
    if (count > 0) (void)dds_return_loan(reader, all.data(), count);
}

Endpoint endpoint_of(const dds_builtintopic_endpoint_t& found) {
    Endpoint endpoint{.topic = found.topic_name, .type = found.type_name};
    dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
    dds_duration_t blocking = 0;
    if (dds_qget_reliability(found.qos, &reliability, &blocking))
        endpoint.reliability =
            reliability == DDS_RELIABILITY_RELIABLE ? Reliability::reliable : Reliability::best_effort;
    dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
    if (dds_qget_durability(found.qos, &durability))
        endpoint.durability =
            durability == DDS_DURABILITY_VOLATILE ? Durability::volatile_ : Durability::transient_local;
    return endpoint;
}

}  // namespace

bool Writer::write(cdr::Bytes message) const {
    return dds_writecdr(writer_.handle(), new_sample(type_, std::move(message))) == DDS_RETCODE_OK;
}

std::uint32_t Writer::readers() const {
    dds_publication_matched_status_t status{};
    (void)dds_get_publication_matched_status(writer_.handle(), &status);
    return status.current_count;
}

std::vector<Sample> Reader::take(std::size_t count) const {
    std::vector<ddsi_serdata*> taken(count, nullptr);
    std::vector<dds_sample_info_t> infos(count);
    const dds_return_t got = dds_takecdr(reader_.handle(), taken.data(), static_cast<std::uint32_t>(count),
                                         infos.data(), DDS_ANY_STATE);
    std::vector<Sample> samples;
    for (dds_return_t i = 0; i < got; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const std::unique_ptr<ddsi_serdata, decltype(&release)> owner(taken[at], &release);
        if (!infos[at].valid_data) continue;
        const auto bytes = bytes_of(taken[at]);
        samples.push_back({{bytes.begin(), bytes.end()},
                           infos[at].publication_handle,
                           arrival_of(taken[at]),
                           number_of(taken[at])});
    }
    return samples;
}

Result<std::unique_ptr<Participant>, Error> Participant::open(const Network& network) {
    std::unique_ptr<Participant> made(new Participant());
    made->signal_.event = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (made->signal_.event < 0)
        return unexpected(Error{ErrorCode::no_resources, std::string("eventfd: ") + std::strerror(errno)});
    if (!network.configuration.empty()) {
        const dds_entity_t domain = dds_create_domain(network.domain, network.configuration.c_str());
        if (domain < 0) return unexpected(cyclone_error("cannot take part in the DDS network", domain));
        made->domain_ = Entity(domain);
    }
    if (network.is_local_only && !receive_from_this_machine_only())
        return unexpected(
            Error{ErrorCode::system_error, "cannot keep the DDS sockets to this machine (SO_ATTACH_FILTER)"});
    const dds_entity_t participant = dds_create_participant(network.domain, nullptr, nullptr);
    if (participant < 0) return unexpected(cyclone_error("cannot take part in the DDS network", participant));
    made->participant_ = Entity(participant);
    (void)dds_get_guid(participant, &made->guid_);
    const ListenerPointer listener = listener_of(&on_others, &made->signal_);
    made->participants_ =
        Entity(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, listener.get()));
    made->publications_ =
        Entity(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, listener.get()));
    return made;
}

Participant::~Participant() {
    publications_ = {};
    participants_ = {};
    participant_ = {};
    domain_ = {};
    if (signal_.event >= 0) ::close(signal_.event);
}

void Participant::on_sample(dds_entity_t, void* signal) {
    (void)::eventfd_write(static_cast<Signal*>(signal)->event, 1);
}

void Participant::on_others(dds_entity_t, void* signal) {
    static_cast<Signal*>(signal)->are_others_new = true;
    (void)::eventfd_write(static_cast<Signal*>(signal)->event, 1);
}

bool Participant::clear() const noexcept {
    eventfd_t count = 0;
    (void)::eventfd_read(signal_.event, &count);
    return signal_.are_others_new.exchange(false);
}

Result<Entity, Error> Participant::topic(const std::string& topic, const ros::TypeName& type,
                                         std::size_t bytes_max, const ddsi_sertype*& registered) const {
    ddsi_sertype* made = new_raw_type(std::string(type.dds), bytes_max);
    const dds_entity_t handle = dds_create_topic_sertype(participant_.handle(), ("rt" + topic).c_str(), &made,
                                                         nullptr, nullptr, nullptr);
    if (handle < 0) return unexpected(cyclone_error("cannot use the topic " + topic, handle));
    registered = made;
    return Entity(handle);
}

Result<Writer, Error> Participant::writer(const std::string& name, const ros::TypeName& type,
                                          const Qos& qos) const {
    const ddsi_sertype* registered = nullptr;
    auto made = topic(name, type, 0, registered);
    if (!made) return unexpected(made.error());
    const dds_entity_t handle =
        dds_create_writer(participant_.handle(), made->handle(), qos_of(qos, type).get(), nullptr);
    if (handle < 0) return unexpected(cyclone_error("cannot publish " + name, handle));
    return Writer(std::move(made).value(), Entity(handle), registered);
}

Result<Reader, Error> Participant::reader(const std::string& name, const ros::TypeName& type, const Qos& qos,
                                          std::size_t bytes_max) const {
    const ddsi_sertype* registered = nullptr;
    auto made = topic(name, type, bytes_max, registered);
    if (!made) return unexpected(made.error());
    const ListenerPointer listener = listener_of(&on_sample, &signal_);
    const dds_entity_t handle =
        dds_create_reader(participant_.handle(), made->handle(), qos_of(qos, type).get(), listener.get());
    if (handle < 0) return unexpected(cyclone_error("cannot subscribe to " + name, handle));
    return Reader(std::move(made).value(), Entity(handle));
}

std::size_t Participant::others() const {
    std::size_t count = 0;
    for_each_sample<dds_builtintopic_participant_t>(
        participants_.handle(), [this, &count](const dds_builtintopic_participant_t& found) {
            count += std::memcmp(found.key.v, guid_.v, sizeof(guid_.v)) != 0 ? 1U : 0U;
        });
    return count;
}

std::vector<Endpoint> Participant::other_writers() const {
    std::vector<Endpoint> writers;
    for_each_sample<dds_builtintopic_endpoint_t>(
        publications_.handle(), [this, &writers](const dds_builtintopic_endpoint_t& found) {
            if (std::memcmp(found.participant_key.v, guid_.v, sizeof(guid_.v)) != 0)
                writers.push_back(endpoint_of(found));
        });
    return writers;
}

}  // namespace octoskin::dds
