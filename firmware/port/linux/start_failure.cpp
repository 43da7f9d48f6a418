#include "firmware/port/linux/start_failure.hpp"

#include <cerrno>
#include <cstring>

namespace octoskin::linux_port {
namespace {

const char* device_remedy(int error_number) {
    switch (error_number) {
        case EACCES:
        case EPERM:
            return "; its group has access: `ls -l` names the group, `sudo usermod -aG GROUP $USER` adds you";
        case EBUSY:
            return "; another process holds it: `gpioinfo` names the holder of a line";
        case ENOENT:
        case ENXIO:
        case ENODEV:
            return "; is it enabled (an I2C bus by dtoverlay and `modprobe i2c-dev`), or named otherwise "
                   "(`gpiodetect`)?";
        default:
            return "";
    }
}

}  // namespace

StartFailure device_failure(const std::string& what, int error_number) {
    const bool is_forbidden = error_number == EACCES || error_number == EPERM;
    return {is_forbidden ? ExitCode::no_permission : ExitCode::unavailable,
            what + ": " + std::strerror(error_number) + device_remedy(error_number)};
}

}  // namespace octoskin::linux_port
