// One I2C bus and its sensors: at any time one of them owns the bus. Whoever has been due longest is next,
// and a due time only moves once its owner was served: so no sensor starves, and a silent one costs its
// neighbours no more than its own failed transfers. Only who must be punctual, to start in its phase or to
// ask for data of which the time is not known well enough, goes before its turn: between the transfers of
// whoever owns the bus, and no transfer is begun that would make it late.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "firmware/core/data_ready_hint.hpp"
#include "firmware/core/default_address.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/sensor.hpp"
#include "firmware/core/shared_bus.hpp"
#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "firmware/drivers/vl53l1x/device.hpp"

namespace octoskin::node {

class BusWorker {
  public:
    BusWorker(i2c::Bus& bus, std::uint32_t i2c_hz, const vl53l1x::Options& options, const Policy& policy,
              const DataReadyHint& hint);

    /// The sensor must outlive the worker. Call for all before the first `poll`.
    void add(Sensor& sensor);
    [[nodiscard]] DefaultAddress& default_address() noexcept { return default_address_; }
    /// Somebody answered at 0x29 whom no XSHUT line put there; parked since.
    [[nodiscard]] bool has_parked() const noexcept { return default_address_.is_somebody_parked(); }

    /// Advances the owner and hands the bus on, a few steps at most. O(steps * sensors of the bus).
    void poll(NodeTime now);
    /// The bus as its sensors see it: busy also while somebody else's poll goes first.
    [[nodiscard]] i2c::Bus& shared_bus() noexcept { return shared_bus_; }

    /// When a sensor next wants the bus; empty while a transfer is in flight, whose end is the next event.
    [[nodiscard]] std::optional<NodeTime> wake_time() const;

    [[nodiscard]] bool has_sensors() const noexcept { return sensor_count_ > 0; }
    [[nodiscard]] const DataReadyHint& hint() const noexcept { return hint_; }
    /// A line is held low and could not be freed.
    [[nodiscard]] bool is_faulty() const noexcept { return is_faulty_; }

  private:
    void follow_hint(NodeTime now);
    void take_turns(NodeTime now);
    void begin_turn(Sensor* sensor, bool may_be_interrupted) noexcept;
    [[nodiscard]] bool is_interrupted(const Sensor* sensor) const noexcept;
    [[nodiscard]] Sensor* longest_interrupted() noexcept;
    void advance_owner(NodeTime now);
    [[nodiscard]] Sensor* first_punctual(NodeTime by) const;
    [[nodiscard]] Sensor* longest_due(NodeTime now, bool is_somebody_punctual) const;
    void free_bus(NodeTime now);

    i2c::Bus& bus_;
    SharedBus shared_bus_{bus_};
    DefaultAddress default_address_;
    DataReadyHint hint_;
    const Policy& policy_;
    std::array<Sensor*, kNodeSensorsMax> sensors_{};
    std::uint8_t sensor_count_ = 0;
    Microseconds longest_read_;
    Microseconds longest_poll_;
    Sensor* owner_ = nullptr;
    bool is_owner_under_way_ = false;  ///< has begun a transfer since its turn began
    bool may_be_interrupted_ = true;
    const Sensor* awaited_ = nullptr;                     ///< the bus is kept free for it until it is due
    std::array<Sensor*, kNodeSensorsMax> interrupted_{};  ///< between two of their transfers; first first
    std::uint8_t interrupted_count_ = 0;
    NodeTime interrupted_at_;  ///< or given a turn since
    bool has_started_ = false;
    bool is_faulty_ = false;
    NodeTime retry_at_;
};

}  // namespace octoskin::node
