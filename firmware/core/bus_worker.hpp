// One I2C bus and its sensors: at any time one of them owns the bus. The next owner is the sensor that has
// been due longest, and a due time moves only after the sensor was served. So no sensor starves, and a silent
// one costs its neighbours no more than its own failed transfers. Only a sensor that must be punctual goes
// before its turn: to start in its phase, or to poll for data whose time is not known well enough. It goes
// between the owner's transfers, and no transfer is begun that would make it late.
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

    /// `sensor` must outlive the worker. Call for all sensors before the first `poll`.
    void add(Sensor& sensor);
    [[nodiscard]] DefaultAddress& default_address() noexcept { return default_address_; }
    /// Whether a device answered at 0x29 without an XSHUT line having released it. It is parked since.
    [[nodiscard]] bool has_parked() const noexcept { return default_address_.is_any_parked(); }

    /// Advances the owner and passes the bus on, in at most 4 steps. O(steps * sensors of the bus).
    void poll(NodeTime now);
    /// The bus as its sensors see it: also busy while another sensor's poll goes first.
    [[nodiscard]] i2c::Bus& shared_bus() noexcept { return shared_bus_; }

    /// When a sensor next needs the bus; empty while a transfer is in flight, whose end is the next event.
    [[nodiscard]] std::optional<NodeTime> wake_time() const;

    [[nodiscard]] bool has_sensors() const noexcept { return sensor_count_ > 0; }
    [[nodiscard]] const DataReadyHint& hint() const noexcept { return hint_; }
    /// Whether a line is held low and could not be freed.
    [[nodiscard]] bool is_faulty() const noexcept { return is_faulty_; }

  private:
    void follow_hint(NodeTime now);
    void take_turns(NodeTime now);
    void begin_turn(Sensor* sensor, bool is_preemptible) noexcept;
    [[nodiscard]] bool is_interrupted(const Sensor* sensor) const noexcept;
    [[nodiscard]] Sensor* longest_interrupted() noexcept;
    void advance_owner(NodeTime now);
    [[nodiscard]] Sensor* first_punctual(NodeTime by) const;
    [[nodiscard]] Sensor* longest_due(NodeTime now, bool is_any_due) const;
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
    bool is_preemptible_ = true;
    const Sensor* awaited_ = nullptr;                     ///< the bus is kept free for it until it is due
    std::array<Sensor*, kNodeSensorsMax> interrupted_{};  ///< between two transfers; earliest first
    std::uint8_t interrupted_count_ = 0;
    NodeTime interrupted_at_;  ///< or since when one of them was given a turn
    bool has_started_ = false;
    bool is_faulty_ = false;
    NodeTime retry_at_;
};

}  // namespace octoskin::node
