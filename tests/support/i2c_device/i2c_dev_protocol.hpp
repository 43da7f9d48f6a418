// A bus with the interface of the kernel's i2c-dev: open, ioctl, read and write of /dev/i2c-N, served from
// user space through CUSE.
#pragma once

#include <memory>
#include <string>

#include "tests/support/i2c_device/served_bus.hpp"

struct fuse_session;

namespace octoskin::test {

/// A bus as /dev/`name`; needs /dev/cuse. I2C_RDWR, I2C_SLAVE with read and write, and I2C_FUNCS; no SMBus
/// calls, no 10-bit addresses. Messages go out as a write with the read behind it, or one by one: longer
/// combined transfers get a STOP between.
class I2cDevice {
  public:
    /// Throws std::runtime_error if the kernel refuses it. `bus` must outlive the device.
    I2cDevice(const std::string& name, ServedBus& bus);

    /// Creates the device; it exists until the process ends.
    void serve();

  private:
    struct EndSession {
        void operator()(fuse_session* session) const noexcept;
    };
    std::unique_ptr<fuse_session, EndSession> session_;
};

}  // namespace octoskin::test
