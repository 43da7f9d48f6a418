// Sends the records of the buses, slowly, after a fault or on command. At most one dump is under way, and its
// recorder is frozen meanwhile.
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
    /// `recorders` must outlive this object.
    BlackBox(BusRecorders& recorders, const Policy& policy) noexcept;

    /// Something failed on `bus`: its record is kept and sent, unless a dump for an earlier fault was sent
    /// less than `black_box_pause` ago, or is under way.
    void on_fault(std::uint8_t bus, NodeTime now) noexcept;
    /// On command, however recent the last dump is. No effect for a bus that does not exist.
    void on_request(std::uint8_t bus, NodeTime now) noexcept;

    /// Records which pauses are over. Call in every turn, before `due`.
    void update(NodeTime now) noexcept;
    /// The piece to send now; empty if there is none, or if the last one was sent too recently.
    [[nodiscard]] std::optional<wire::BlackBox> due() const noexcept;
    /// `due()` was handed to the bus.
    void sent(NodeTime now) noexcept;
    /// When `due` next has something; empty if nothing is to be sent.
    [[nodiscard]] std::optional<NodeTime> wake_time(NodeTime now) const noexcept;

  private:
    [[nodiscard]] bool is_pending(std::uint8_t bus) const noexcept { return ((pending_ >> bus) & 1U) != 0; }

    BusRecorders& recorders_;
    const Policy& policy_;
    std::uint8_t pending_ = 0;  ///< bit i: bus i is frozen, and its dump waits or is under way
    std::uint8_t current_ = 0;  ///< the bus of the dump under way, if any; others wait for its end
    std::uint16_t index_ = 0;   ///< of that dump's next piece
    std::uint8_t dump_ = 0;
    Pause piece_pause_;
    std::array<Pause, kNodeBusesMax> fault_pauses_{};
};

}  // namespace octoskin::node
