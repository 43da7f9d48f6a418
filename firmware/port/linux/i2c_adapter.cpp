#include "firmware/port/linux/i2c_adapter.hpp"

#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

namespace octoskin::linux_port {
namespace {

constexpr unsigned long kTimeoutTens = 2;  // I2C_TIMEOUT, in units of 10 ms

i2c_msg message(const i2c::Transfer& transfer, bool is_read) {
    // The kernel's type has no const. The kernel writes to messages with I2C_M_RD only.
    auto* bytes = is_read ? transfer.read.data() : const_cast<std::uint8_t*>(transfer.write.data());
    const std::size_t size = is_read ? transfer.read.size() : transfer.write.size();
    return {.addr = transfer.address,
            .flags = static_cast<__u16>(is_read ? I2C_M_RD : 0),
            .len = static_cast<__u16>(size),
            .buf = bytes};
}

}  // namespace

i2c::TransferError transfer_error(int error_number) noexcept {
    switch (error_number) {
        case ENXIO:
        case EREMOTEIO:
            return i2c::TransferError::nack_address;
        case EIO:
            return i2c::TransferError::nack_data;
        case ETIMEDOUT:
            return i2c::TransferError::timeout;
        case EAGAIN:
            return i2c::TransferError::arbitration_lost;
        default:
            return i2c::TransferError::bus_stuck;
    }
}

Result<I2cDevice, StartFailure> I2cDevice::open(const std::string& path) {
    I2cDevice device(::open(path.c_str(), O_RDWR | O_CLOEXEC));
    if (device.descriptor_ < 0) return unexpected(device_failure(path, errno));
    unsigned long functions = 0;
    if (::ioctl(device.descriptor_, I2C_FUNCS, &functions) != 0)
        return refuse(ExitCode::unavailable, path + ": not an I2C adapter of i2c-dev");
    if ((functions & I2C_FUNC_I2C) == 0)
        return refuse(ExitCode::unavailable,
                      path + ": this adapter supports SMBus only; a sensor's registers need plain I2C");
    // Not every driver supports these; then its own limits apply.
    (void)::ioctl(device.descriptor_, I2C_TIMEOUT, kTimeoutTens);
    (void)::ioctl(device.descriptor_, I2C_RETRIES, 0UL);
    return device;
}

I2cDevice::~I2cDevice() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

I2cDevice::I2cDevice(I2cDevice&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

I2cDevice& I2cDevice::operator=(I2cDevice&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

int I2cDevice::transfer(const i2c::Transfer& transfer) {
    std::array<i2c_msg, 2> messages{};
    __u32 count = 0;
    const bool is_only_read = transfer.write.empty() && !transfer.read.empty();
    if (!is_only_read) messages[count++] = message(transfer, false);
    if (!transfer.read.empty()) messages[count++] = message(transfer, true);
    i2c_rdwr_ioctl_data list{.msgs = messages.data(), .nmsgs = count};
    return ::ioctl(descriptor_, I2C_RDWR, &list) < 0 ? errno : 0;
}

}  // namespace octoskin::linux_port
