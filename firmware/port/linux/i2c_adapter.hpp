// One Linux I2C adapter: /dev/i2c-N through i2c-dev, write and read in one I2C_RDWR.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "common/result.hpp"
#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "firmware/port/linux/start_failure.hpp"

namespace octoskin::linux_port {

/// Interface between a bus's thread and its adapter.
class I2cAdapter {
  public:
    /// Returns 0 or the kernel's error number. Blocks until the kernel has finished.
    [[nodiscard]] virtual int transfer(const i2c::Transfer& transfer) = 0;

  protected:
    ~I2cAdapter() = default;
};

/// Maps an error number (Documentation/i2c/fault-codes.rst of the kernel) to a driver's error. Some adapters
/// do not distinguish a refused byte from a refused address: EREMOTEIO, used for both on the Raspberry Pi,
/// counts as the address. Any other error counts as `bus_stuck`.
[[nodiscard]] i2c::TransferError transfer_error(int error_number) noexcept;

class I2cDevice final : public I2cAdapter {
  public:
    /// `path`: for example "/dev/i2c-1". Errors: no such device, no permission, not an I2C adapter, or an
    /// adapter with SMBus only.
    [[nodiscard]] static Result<I2cDevice, StartFailure> open(const std::string& path);
    ~I2cDevice();
    I2cDevice(I2cDevice&& other) noexcept;
    I2cDevice& operator=(I2cDevice&& other) noexcept;

    /// The kernel gives up after 20 ms if the adapter's driver obeys I2C_TIMEOUT, else after the driver's own
    /// limit, usually 1 s.
    [[nodiscard]] int transfer(const i2c::Transfer& transfer) override;

  private:
    explicit I2cDevice(int descriptor) noexcept : descriptor_(descriptor) {}
    int descriptor_ = -1;
};

}  // namespace octoskin::linux_port
