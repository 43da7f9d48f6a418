// When the node reports about itself: the heartbeat at 10 Hz, each NODE_INFO page and each sensor's health
// once a second, spread evenly, and earlier after a change. It stores only which reports are due. A report is
// composed when it is sent, so it is never out of date and never queues up.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/policy.hpp"

namespace octoskin::node {

class Announcer {
  public:
    Announcer(std::uint8_t sensor_count, const Policy& policy, NodeTime now) noexcept;

    /// Records what is due by `now`.
    void update(NodeTime now) noexcept;
    /// When `update` next has something to record.
    [[nodiscard]] NodeTime next_due() const noexcept;

    /// Quiet: the node sends only its heartbeat unasked, but answers requests. When this ends, every report
    /// is due at once.
    void set_quiet(bool is_quiet) noexcept;

    void request_all() noexcept;
    void request_info(wire::InfoPage page) noexcept {
        info_due_ = static_cast<std::uint8_t>(info_due_ | (1U << static_cast<unsigned>(page)));
    }
    void request_health(std::uint8_t sensor) noexcept { health_due_ |= std::uint64_t{1} << sensor; }

    [[nodiscard]] bool is_heartbeat_due() const noexcept { return is_heartbeat_due_; }
    [[nodiscard]] std::optional<wire::InfoPage> info_page_due() const noexcept;
    [[nodiscard]] std::optional<std::uint8_t> health_due() const noexcept;

    void heartbeat_sent() noexcept { is_heartbeat_due_ = false; }
    void info_sent(wire::InfoPage page) noexcept;
    void health_sent(std::uint8_t sensor) noexcept;

  private:
    /// An even rhythm that does not drift, and does not catch up after a pause.
    struct Rhythm {
        Microseconds period{0};
        NodeTime next;
        [[nodiscard]] bool beats(NodeTime now) noexcept;
    };

    [[nodiscard]] static Rhythm every(Microseconds period, NodeTime now) noexcept;

    std::uint8_t sensor_count_;
    Rhythm heartbeat_;
    Rhythm info_;
    Rhythm health_;
    bool is_heartbeat_due_ = true;
    bool is_quiet_ = false;
    std::uint8_t info_due_;         ///< bit i: page i
    std::uint64_t health_due_ = 0;  ///< bit i: sensor i
    std::uint8_t info_turn_ = 0;
    std::uint8_t health_turn_ = 0;
    std::uint8_t health_first_ = 0;  ///< where the search starts, so that no sensor is always last
};

}  // namespace octoskin::node
