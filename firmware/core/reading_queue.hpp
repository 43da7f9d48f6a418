// The readings that wait for the bus: at most one per sensor, since a newer one displaces an older one, and
// none for longer than its age limit. Every loss is counted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/reading.hpp"

namespace octoskin::node {

struct QueueLosses {
    std::uint32_t displaced = 0;  ///< by a newer reading of the same sensor
    std::uint32_t late = 0;       ///< waited longer than `reading_age_max`
};

class ReadingQueue {
  public:
    ReadingQueue(bool uses_can_fd, std::uint8_t aux_every, const Policy& policy) noexcept;

    /// O(sensors).
    void push(std::uint8_t sensor, const Reading& reading, NodeTime now) noexcept;

    /// Drops readings that have waited too long. O(waiting).
    void drop_late(NodeTime now) noexcept;

    /// Whether a frame can be sent now. Classical: one reading is enough. CAN FD: a full frame, or one
    /// reading that has waited for `company_wait`.
    [[nodiscard]] bool is_ready(NodeTime now) const noexcept;
    /// When `is_ready` becomes true without another reading; empty if nothing waits.
    [[nodiscard]] std::optional<NodeTime> ready_time() const noexcept;

    /// The next frame's content, oldest readings first; only while something waits. Sequence numbers count
    /// the readings sent, so that a gap always means a loss on the bus.
    [[nodiscard]] wire::Message front() const noexcept;
    /// `front()` was handed to the bus.
    void pop() noexcept;

    /// Classical only: the signal figures of every `aux_every`-th reading sent. They are not needed for
    /// acceptance: a newer one displaces one that could not be sent yet.
    [[nodiscard]] const std::optional<wire::RangeAux>& aux() const noexcept { return aux_; }
    void pop_aux() noexcept { aux_.reset(); }

    [[nodiscard]] std::size_t waiting() const noexcept { return waiting_; }
    [[nodiscard]] std::uint32_t total_sent() const noexcept { return total_sent_; }
    [[nodiscard]] std::uint16_t sent(std::uint8_t sensor) const noexcept { return sent_[sensor]; }
    [[nodiscard]] const QueueLosses& losses() const noexcept { return losses_; }

  private:
    struct Waiting {
        std::uint8_t sensor = 0;
        Reading reading;
        NodeTime since;
    };

    [[nodiscard]] std::uint8_t frame_capacity() const noexcept;
    [[nodiscard]] std::uint8_t frame_count() const noexcept;
    [[nodiscard]] wire::RangeReading on_wire(const Waiting& waiting) const noexcept;
    void remove_first(std::uint8_t count) noexcept;
    void note_aux(const Waiting& sent) noexcept;

    bool uses_can_fd_;
    std::uint8_t aux_every_;
    const Policy& policy_;
    std::uint8_t waiting_ = 0;
    std::array<Waiting, kNodeSensorsMax> queue_{};  ///< oldest first
    std::array<std::uint16_t, kNodeSensorsMax> sent_{};
    std::uint32_t total_sent_ = 0;
    std::optional<wire::RangeAux> aux_;
    QueueLosses losses_;
};

}  // namespace octoskin::node
