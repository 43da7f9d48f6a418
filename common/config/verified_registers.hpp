// The registers of a VL53L1X that are read back and compared with what was written. The driver reads them; a
// rig may leave some of them out.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace octoskin {

/// Registers that are read back in one transfer.
struct RegisterRun {
    std::uint16_t first = 0;
    std::uint8_t count = 0;
};
/// All registers that the driver configures, except 0x31 and 0x32 (levels of pins) and 0x86 and 0x87
/// (commands). The first three runs scale, steer or time the range. First: offset. Second: time-outs, VCSEL
/// periods, limits, valid phase and inter-measurement period. Third: windows, initial phases, region of
/// interest, sequence.
inline constexpr std::array<RegisterRun, 10> kRegisterRuns{{{0x1E, 6},
                                                            {0x5E, 18},
                                                            {0x78, 14},
                                                            {0x08, 4},
                                                            {0x16, 6},
                                                            {0x2D, 4},
                                                            {0x33, 16},
                                                            {0x43, 16},
                                                            {0x53, 11},
                                                            {0x70, 8}}};
inline constexpr std::uint8_t kVerifiedRegisterMax = 0x85;

[[nodiscard]] constexpr bool is_verified(std::uint16_t index) noexcept {
    return std::any_of(kRegisterRuns.begin(), kRegisterRuns.end(), [index](const RegisterRun& run) {
        return index >= run.first && index < run.first + run.count;
    });
}
static_assert(is_verified(kVerifiedRegisterMax) && !is_verified(kVerifiedRegisterMax + 1));

}  // namespace octoskin
