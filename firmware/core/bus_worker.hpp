// One I2C bus and its sensors: at any time one of them owns the bus. Whoever has been due longest is next,
// and a due time only moves once its owner was served: so no sensor starves, and a silent one costs its
// neighbours no more than its own failed transfers.
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
#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "firmware/drivers/vl53l1x/device.hpp"

namespace octoskin::node {

class BusWorker {
  public:
    BusWorker(i2c::Bus& bus, const vl53l1x::Options& options, const Policy& policy,
              const DataReadyHint& hint);

    /// The sensor must outlive the worker. Call for all before the first `poll`.
    void add(Sensor& sensor);
    [[nodiscard]] DefaultAddress& default_address() noexcept { return default_address_; }
    /// Somebody answered at 0x29 whom no XSHUT line put there; parked since.
    [[nodiscard]] bool has_parked() const noexcept { return default_address_.is_somebody_parked(); }

    /// Advances the owner and hands the bus on, a few steps at most. O(steps * sensors of the bus).
    void poll(NodeTime now);

    /// When a sensor next wants the bus; empty while a transfer is in flight, whose end is the next event.
    [[nodiscard]] std::optional<NodeTime> wake_time() const;

    [[nodiscard]] bool has_sensors() const noexcept { return sensor_count_ > 0; }
    [[nodiscard]] const DataReadyHint& hint() const noexcept { return hint_; }
    /// A line is held low and could not be freed.
    [[nodiscard]] bool is_faulty() const noexcept { return is_faulty_; }

  private:
    void follow_hint(NodeTime now);
    [[nodiscard]] Sensor* longest_due(NodeTime now) const;
    void free_bus(NodeTime now);

    i2c::Bus& bus_;
    DefaultAddress default_address_;
    DataReadyHint hint_;
    const Policy& policy_;
    std::array<Sensor*, kNodeSensorsMax> sensors_{};
    std::uint8_t sensor_count_ = 0;
    Sensor* owner_ = nullptr;
    bool has_started_ = false;
    bool is_faulty_ = false;
    NodeTime retry_at_;
};

}  // namespace octoskin::node
