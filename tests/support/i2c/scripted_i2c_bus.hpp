// An I2C bus that follows a script: every transfer must be the next one expected, and none may be left over.
// A difference fails the running test.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "tests/support/i2c/i2c_trace.hpp"

namespace octoskin::test {

class ScriptedI2cBus final : public i2c::Bus {
  public:
    explicit ScriptedI2cBus(Trace script) : script_(std::move(script)) {}
    explicit ScriptedI2cBus(std::string_view script) : ScriptedI2cBus(parse_trace(script)) {}
    ScriptedI2cBus(const ScriptedI2cBus&) = delete;
    ScriptedI2cBus& operator=(const ScriptedI2cBus&) = delete;
    ~ScriptedI2cBus();

    /// Adds to the end of the script.
    void expect(std::string_view script);
    void expect(const Trace& script) { script_.insert(script_.end(), script.begin(), script.end()); }
    /// The next transfers expected end in these errors instead of an answer.
    void expect_failure(std::string_view entry, i2c::TransferError error);
    [[nodiscard]] bool is_finished() const noexcept { return next_ == script_.size(); }

    [[nodiscard]] bool is_busy() const override { return is_in_flight_; }
    void submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) override;
    [[nodiscard]] i2c::TransferState poll(NodeTime now) override;
    [[nodiscard]] i2c::TransferError error() const override { return error_; }
    bool recover() override;

    /// The deadline that came with the last transfer, from its start.
    [[nodiscard]] Microseconds last_time_limit() const noexcept { return last_time_limit_; }

  private:
    Trace script_;
    std::size_t next_ = 0;
    bool is_in_flight_ = false;
    i2c::Transfer transfer_;
    i2c::TransferError error_ = i2c::TransferError::timeout;
    Microseconds last_time_limit_{0};
};

}  // namespace octoskin::test
