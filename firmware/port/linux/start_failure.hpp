// Why a node cannot start on this machine: a message and an exit code of sysexits.h.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "common/result.hpp"

namespace octoskin::linux_port {

enum class ExitCode : std::uint8_t {
    ok = 0,
    usage = 64,          ///< the command line
    no_input = 66,       ///< the configuration block does not exist or cannot be read
    unavailable = 69,    ///< a device does not exist, or another process holds it
    defect = 70,         ///< a defect of this program
    no_permission = 77,  ///< no permission to use a device
    bad_config = 78,     ///< the configuration block is invalid or does not fit the command line
};

struct StartFailure {
    ExitCode code = ExitCode::unavailable;
    std::string what;  ///< object, place, reason and remedy
};

[[nodiscard]] inline Unexpected<StartFailure> refuse(ExitCode code, std::string what) {
    return unexpected(StartFailure{code, std::move(what)});
}

/// The failure of `what` with the kernel's `error_number`.
[[nodiscard]] StartFailure device_failure(const std::string& what, int error_number);

}  // namespace octoskin::linux_port
