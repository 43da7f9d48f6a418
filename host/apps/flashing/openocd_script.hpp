// The script with which OpenOCD programs one board. It executes steps and prints markers; openocd_outcome.hpp
// evaluates the output.
#pragma once

#include <cstdint>
#include <string>

namespace octoskin::flashing {

/// In the folder of the script, which finds it relative to itself.
inline constexpr const char* kHexFile = "flash.hex";
inline constexpr const char* kScriptFile = "flash.cfg";

/// Prefixes of the script's own lines in OpenOCD's output. A value follows the first two.
inline constexpr const char* kSaysDevice = "octoskin: device ";
inline constexpr const char* kSaysOptions = "octoskin: options ";
inline constexpr const char* kSaysProgrammed = "octoskin: programmed";
inline constexpr const char* kSaysVerified = "octoskin: verified";
inline constexpr const char* kSaysStarted = "octoskin: started";

struct ScriptPlan {
    std::string openocd_board;    ///< a script that comes with OpenOCD
    std::uint32_t device_id = 0;  ///< any other chip is left untouched
    std::string adapter_serial;   ///< letters and digits; empty: any ST-LINK
    bool writes_option_bytes = false;
};

/// To be run with `openocd -f FOLDER/flash.cfg` in any working directory; the hex file is in the same folder.
/// With `-c "set octoskin_dry_run 1"` before it, OpenOCD connects to nothing and lists the flash banks, which
/// shows that it could read the whole script.
[[nodiscard]] std::string openocd_script(const ScriptPlan& plan);

}  // namespace octoskin::flashing
