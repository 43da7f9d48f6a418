// Turns OpenOCD's output into a result: programmed, or an error with its cause and remedy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/apps/flashing/openocd_run.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin::flashing {

/// The image is in flash, verified and started.
struct Programmed {
    std::uint32_t flash_optr = 0;  ///< option bytes as last read
};

struct Expected {
    std::uint32_t device_id = 0;
    std::string adapter_serial;  ///< empty: any
};

/// Evaluates a run of the whole script. Errors: `unavailable` if OpenOCD, the adapter or the chip is missing;
/// `no_permission`; `io_failed` if programming, verifying or starting failed.
[[nodiscard]] Result<Programmed, AppError> judge(const OpenocdRun& run, const Expected& expected);

/// Evaluates a dry run: no error if OpenOCD has read the script.
[[nodiscard]] std::optional<AppError> judge_dry_run(const OpenocdRun& run);

}  // namespace octoskin::flashing
