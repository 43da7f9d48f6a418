// Why a node cannot start on this machine, as a sentence and an exit code after sysexits.h.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "common/result.hpp"

namespace octoskin::linux_port {

enum class ExitCode : std::uint8_t {
    ok = 0,
    usage = 64,          ///< the command line
    no_input = 66,       ///< the configuration block is not there
    unavailable = 69,    ///< a device is not there, or somebody else has it
    defect = 70,         ///< a defect of this program
    no_permission = 77,  ///< to use a device
    bad_config = 78,     ///< the configuration block, or it and the command line do not fit
};

struct StartFailure {
    ExitCode code = ExitCode::unavailable;
    std::string what;  ///< what, where, why, what to do
};

[[nodiscard]] inline Unexpected<StartFailure> refuse(ExitCode code, std::string what) {
    return unexpected(StartFailure{code, std::move(what)});
}

/// `what` failed with the kernel's `error_number`.
[[nodiscard]] StartFailure device_failure(const std::string& what, int error_number);

}  // namespace octoskin::linux_port
