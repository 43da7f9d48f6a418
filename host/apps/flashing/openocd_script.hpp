// The script that OpenOCD runs to program one board. It only does and tells; what it told is judged by
// `openocd_verdict`.
#pragma once

#include <cstdint>
#include <string>

namespace octoskin::flashing {

/// Beside the script, which finds it by its own place.
inline constexpr const char* kHexFile = "flash.hex";
inline constexpr const char* kScriptFile = "flash.cfg";

/// Words that begin the script's own lines in OpenOCD's output; a value follows the first two.
inline constexpr const char* kSaysDevice = "octoskin: device ";
inline constexpr const char* kSaysOptions = "octoskin: options ";
inline constexpr const char* kSaysProgrammed = "octoskin: programmed";
inline constexpr const char* kSaysVerified = "octoskin: verified";
inline constexpr const char* kSaysStarted = "octoskin: started";

struct ScriptPlan {
    std::string openocd_board;    ///< a script that OpenOCD ships
    std::uint32_t device_id = 0;  ///< nothing is touched on any other chip
    std::string adapter_serial;   ///< letters and digits; empty: whichever ST-LINK there is
    bool writes_option_bytes = false;
};

/// Run by `openocd -f FOLDER/flash.cfg`, in whatever working directory; the hex file lies beside it. With `-c
/// "set octoskin_dry_run 1"` before, it connects to nothing and lists the flash banks: then OpenOCD has read
/// all of it.
[[nodiscard]] std::string openocd_script(const ScriptPlan& plan);

}  // namespace octoskin::flashing
