// One DDS participant: writers and readers of ROS 2 topics, and which others there are.
#pragma once

#include <dds/dds.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/bridge/cdr/cdr_writer.hpp"
#include "host/bridge/dds/network.hpp"
#include "host/bridge/messages/qos.hpp"
#include "host/bridge/messages/type_name.hpp"
#include "host/errors/error.hpp"

struct ddsi_sertype;

namespace octoskin::dds {

using ros::Durability;
using ros::Qos;
using ros::Reliability;

/// An entity of Cyclone DDS; deleted with this object.
class Entity {
  public:
    Entity() noexcept = default;
    explicit Entity(dds_entity_t handle) noexcept : handle_(handle) {}
    Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
    Entity& operator=(Entity&& other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Entity() {
        if (handle_ > 0) (void)dds_delete(handle_);
    }
    [[nodiscard]] dds_entity_t handle() const noexcept { return handle_; }

  private:
    dds_entity_t handle_ = 0;
};

class Writer {
  public:
    Writer() = default;
    Writer(Entity topic, Entity writer, const ddsi_sertype* type)
        : topic_(std::move(topic)), writer_(std::move(writer)), type_(type) {}

    /// Sends a message, encoded by cdr::write. Readers that hang do not delay it: it replaces the one that
    /// waits for them. False: Cyclone DDS refused it. Throws std::bad_alloc.
    [[nodiscard]] bool write(cdr::Bytes message) const;
    /// Number of readers that get the messages.
    [[nodiscard]] std::uint32_t readers() const;

  private:
    Entity topic_;
    Entity writer_;
    const ddsi_sertype* type_ = nullptr;
};

/// A received sample.
struct Sample {
    cdr::Bytes bytes;
    std::uint64_t writer = 0;  ///< which of the topic's writers sent it
    HostTime arrived;          ///< when its last part was received
    std::int64_t number = 0;   ///< the writer numbers its samples from 1
};

class Reader {
  public:
    Reader() = default;
    Reader(Entity topic, Entity reader) : topic_(std::move(topic)), reader_(std::move(reader)) {}

    [[nodiscard]] explicit operator bool() const noexcept { return reader_.handle() > 0; }
    /// The samples that wait, in order, at most `count`. Throws std::bad_alloc.
    [[nodiscard]] std::vector<Sample> take(std::size_t count) const;

  private:
    Entity topic_;
    Entity reader_;
};

/// A writer or reader of another participant.
struct Endpoint {
    std::string topic;  ///< of DDS: "rt/joint_states"
    std::string type;
    Reliability reliability = Reliability::reliable;
    Durability durability = Durability::volatile_;
};

class Participant {
  public:
    /// The error names what the network configuration or Cyclone DDS says.
    [[nodiscard]] static Result<std::unique_ptr<Participant>, Error> open(const Network& network);
    ~Participant();
    Participant(const Participant&) = delete;
    Participant& operator=(const Participant&) = delete;

    /// `topic`: of ROS, beginning with "/".
    [[nodiscard]] Result<Writer, Error> writer(const std::string& topic, const ros::TypeName& type,
                                               const Qos& qos) const;
    /// Messages of more than `bytes_max` are dropped on arrival.
    [[nodiscard]] Result<Reader, Error> reader(const std::string& topic, const ros::TypeName& type,
                                               const Qos& qos, std::size_t bytes_max) const;

    /// Readable when a sample or an endpoint has come or gone, until `clear`.
    [[nodiscard]] int descriptor() const noexcept { return signal_.event; }
    /// Whether participants or writers have come or gone since the last call.
    bool clear() const noexcept;

    /// Number of participants besides this one.
    [[nodiscard]] std::size_t others() const;
    /// Writers of other participants. O(all).
    [[nodiscard]] std::vector<Endpoint> other_writers() const;

  private:
    Participant() = default;
    [[nodiscard]] Result<Entity, Error> topic(const std::string& topic, const ros::TypeName& type,
                                              std::size_t bytes_max, const ddsi_sertype*& registered) const;

    /// Listeners write it, from threads of Cyclone DDS.
    struct Signal {
        int event = -1;
        std::atomic<bool> are_others_new = true;
    };
    static void on_sample(dds_entity_t, void* signal);
    static void on_others(dds_entity_t, void* signal);

    mutable Signal signal_;
    Entity domain_;  ///< destroyed last
    Entity participant_;
    Entity participants_;
    Entity publications_;
    dds_guid_t guid_{};
};

}  // namespace octoskin::dds
