// The host's transmissions, simulated: SYNC once a second, its FOLLOW_UP, and the marks of the recorder.
#pragma once

#include <optional>
#include <vector>

#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// The host's monotonic clock in a simulation: it started long before the simulation.
class SimulatedHostClock {
  public:
    explicit SimulatedHostClock(HostTime at_start) : at_start_(at_start) {}
    [[nodiscard]] HostTime at(SimTime time) const noexcept { return at_start_ + Microseconds{time.us}; }

  private:
    HostTime at_start_;
};

class SyncMaster {
  public:
    SyncMaster(SimulatedHostClock clock, Microseconds sync_period)
        : clock_(clock), sync_period_(sync_period) {}

    /// The frames to send at `now`: a SYNC when one is due, and the queued frames.
    [[nodiscard]] std::vector<wire::CanFrame> poll(SimTime now);
    /// Call at the end of every frame on the bus, own frames included: FOLLOW_UP contains the time of the own
    /// SYNC's end.
    void on_frame(const wire::CanFrame& frame, SimTime end);
    void mark(wire::MarkKind kind, SimTime at);

  private:
    SimulatedHostClock clock_;
    Microseconds sync_period_;
    SimTime next_sync_{};
    std::uint8_t sequence_ = 0;
    std::vector<wire::CanFrame> queue_;
};

}  // namespace octoskin::sim
