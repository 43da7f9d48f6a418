// Sends what the recorders of the buses hold, slowly, after a fault or on command: at most one dump is under
// way, and its recorder stands still meanwhile.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/bus_recorder.hpp"
#include "firmware/core/pause.hpp"
#include "firmware/core/policy.hpp"

namespace octoskin::node {

using BusRecorders = std::array<std::optional<BusRecorder>, kNodeBusesMax>;

class BlackBox {
  public:
    /// `recorders` must outlive the black box.
    BlackBox(BusRecorders& recorders, const Policy& policy) noexcept;

    /// Something failed on `bus`: what led there is kept and sent, unless it was sent for an earlier fault
    /// less than `black_box_pause` ago, or is on its way.
    void on_fault(std::uint8_t bus, NodeTime now) noexcept;
    /// On somebody's order, whenever it was sent last. Nothing for a bus that is not there.
    void on_request(std::uint8_t bus, NodeTime now) noexcept;

    /// Notes which pauses are over. Call in every turn, before `due`.
    void update(NodeTime now) noexcept;
    /// The piece to send now; empty while there is none, or the last one was sent too short a time ago.
    [[nodiscard]] std::optional<wire::BlackBox> due() const noexcept;
    /// `due()` was handed to the bus.
    void sent(NodeTime now) noexcept;
    /// When `due` next has something; empty if nothing is to be sent.
    [[nodiscard]] std::optional<NodeTime> wake_time(NodeTime now) const noexcept;

  private:
    [[nodiscard]] bool is_pending(std::uint8_t bus) const noexcept { return ((pending_ >> bus) & 1U) != 0; }

    BusRecorders& recorders_;
    const Policy& policy_;
    std::uint8_t pending_ = 0;  ///< bit i: bus i is frozen, and to be sent or being sent
    std::uint8_t current_ = 0;  ///< the bus of the dump under way, if any: others wait until it has ended
    std::uint16_t index_ = 0;   ///< of its next piece
    std::uint8_t dump_ = 0;
    Pause piece_pause_;
    std::array<Pause, kNodeBusesMax> fault_pauses_{};
};

}  // namespace octoskin::node
