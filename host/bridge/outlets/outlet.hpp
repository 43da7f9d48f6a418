// A topic that the bridge publishes, and when a message of it is due.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/time.hpp"
#include "host/bridge/cdr/cdr_writer.hpp"
#include "host/bridge/topics/topic_sink.hpp"

namespace octoskin::bridge {

/// A late reader gets the last message.
inline constexpr ros::Qos kLastMessage{ros::Reliability::reliable, ros::Durability::transient_local, 1};

class Outlet {
  public:
    /// Of messages `M`. The error names the topic.
    template <cdr::Message M>
    [[nodiscard]] static Result<Outlet, Error> open(TopicSink& sink, std::string topic, const ros::Qos& qos) {
        auto writer = sink.writer(topic, M::kType, qos);
        if (!writer) return unexpected(writer.error());
        return Outlet(std::move(topic), std::move(writer).value());
    }

    [[nodiscard]] const std::string& topic() const noexcept { return topic_; }
    [[nodiscard]] std::uint32_t readers() const { return writer_->readers(); }
    [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
    [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }  ///< by the sink

    /// A late reader gets none of the messages sent so far.
    void forget_messages() { writer_->forget_messages(); }
    /// `when`: the time of the message's content.
    void send(const cdr::Message auto& message, WallTime when) {
        ++(writer_->write(cdr::write(message), when) ? sent_ : refused_);
    }

  private:
    Outlet(std::string topic, std::unique_ptr<TopicWriter> writer)
        : topic_(std::move(topic)), writer_(std::move(writer)) {}

    std::string topic_;
    std::unique_ptr<TopicWriter> writer_;
    std::uint64_t sent_ = 0;
    std::uint64_t refused_ = 0;
};

/// When the map is due on a topic.
struct Pace {
    /// Maps and the turns in which they are sent come at 20 ms or multiples, but not exactly.
    static constexpr Nanoseconds kTolerance{10'000'000};
    Nanoseconds period_min{0};      ///< between two maps that differ
    Nanoseconds urgent_min{0};      ///< the same if free space became occupied
    Nanoseconds repeated_after{0};  ///< an unchanged map is sent again; 0: never

    /// The state of one topic.
    struct Sent {
        std::optional<HostTime> when;
        std::uint64_t generation = 0;  ///< of the map
    };
    [[nodiscard]] bool is_due(const Sent& sent, std::uint64_t generation, bool is_urgent,
                              HostTime now) const noexcept {
        if (!sent.when) return true;
        const Nanoseconds passed = now - *sent.when + kTolerance;
        if (repeated_after.count() > 0 && passed >= repeated_after) return true;
        return sent.generation != generation && passed >= (is_urgent ? urgent_min : period_min);
    }
};

}  // namespace octoskin::bridge
