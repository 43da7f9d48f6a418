// An I2C bus as the sensors that share it see it: also busy while another sensor's poll goes first.
#pragma once

#include "common/time.hpp"
#include "firmware/drivers/i2c/i2c_bus.hpp"

namespace octoskin::node {

class SharedBus final : public i2c::Bus {
  public:
    /// `bus` must outlive this object.
    explicit SharedBus(i2c::Bus& bus) noexcept : bus_(bus) {}
    /// While held, no sensor begins a transfer; one in flight continues.
    void hold(bool is_held) noexcept { is_held_ = is_held; }

    [[nodiscard]] bool is_busy() const override { return is_held_ || bus_.is_busy(); }
    void submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) override {
        bus_.submit(transfer, now, deadline);
    }
    [[nodiscard]] i2c::TransferState poll(NodeTime now) override { return bus_.poll(now); }
    [[nodiscard]] i2c::TransferError error() const override { return bus_.error(); }
    bool recover() override { return bus_.recover(); }

  private:
    i2c::Bus& bus_;
    bool is_held_ = false;
};

}  // namespace octoskin::node
