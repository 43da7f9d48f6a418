// A bus as the kernel's i2c-dev shows it: what open, ioctl, read and write of /dev/i2c-N do, served from user
// space through CUSE.
#pragma once

#include <string>

#include "tests/support/i2c_device/served_bus.hpp"

namespace octoskin::test {

/// Serves `bus` as /dev/`name` until SIGINT or SIGTERM; needs /dev/cuse. Returns 0 after a signal, else not.
/// I2C_RDWR, I2C_SLAVE with read and write, and I2C_FUNCS; no SMBus calls, no 10-bit addresses. Messages go
/// out as a write with the read behind it, or one by one: longer combined transfers get a STOP between.
[[nodiscard]] int serve_i2c_device(const std::string& name, ServedBus& bus);

}  // namespace octoskin::test
