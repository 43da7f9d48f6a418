// One I2C adapter of Linux: /dev/i2c-N through i2c-dev, write and read in one I2C_RDWR.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "common/result.hpp"
#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "firmware/port/linux/start_failure.hpp"

namespace octoskin::linux_port {

/// What a bus's thread needs of an adapter.
class I2cAdapter {
  public:
    /// 0, or the kernel's error number. Blocks until the kernel is done with it.
    [[nodiscard]] virtual int transfer(const i2c::Transfer& transfer) = 0;

  protected:
    ~I2cAdapter() = default;
};

/// What an error number of the kernel's Documentation/i2c/fault-codes.rst means to a driver. Not every
/// adapter tells a refused byte from a refused address: EREMOTEIO, the Raspberry Pi's answer to both, counts
/// as the address. Whatever else goes wrong counts as a bus that does not work.
[[nodiscard]] i2c::TransferError transfer_error(int error_number) noexcept;

class I2cDevice final : public I2cAdapter {
  public:
    /// `path`: "/dev/i2c-1". Refused if it is not there, not permitted, not an adapter, or one that knows
    /// SMBus only.
    [[nodiscard]] static Result<I2cDevice, StartFailure> open(const std::string& path);
    ~I2cDevice();
    I2cDevice(I2cDevice&& other) noexcept;
    I2cDevice& operator=(I2cDevice&& other) noexcept;

    /// The kernel gives up after 20 ms where the adapter's driver obeys I2C_TIMEOUT, else after its own
    /// limit: 1 s is usual.
    [[nodiscard]] int transfer(const i2c::Transfer& transfer) override;

  private:
    explicit I2cDevice(int descriptor) noexcept : descriptor_(descriptor) {}
    int descriptor_ = -1;
};

}  // namespace octoskin::linux_port
