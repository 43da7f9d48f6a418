// Values of TIMINGR for the controller's clock and the bus rate.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace octoskin::stm32g4 {

struct I2cTiming {
    std::uint32_t kernel_hz = 0;
    std::uint32_t bus_hz = 0;  ///< upper limit for every filter delay and rise time
    std::uint32_t timingr = 0;
};

/// Low and high times of the I2C specification (UM10204 table 10) for the slowest permitted edges and an
/// analogue filter of 50 to 260 ns (DS12288). A 400 kHz bus then runs at 272 to 400 kHz.
inline constexpr auto kI2cTimings = std::to_array<I2cTiming>({
    {160'000'000, 100'000, 0xD0E3'3B34},
    {160'000'000, 400'000, 0x30FA'2C31},
    {16'000'000, 100'000, 0x4031'0F0E},
    {16'000'000, 400'000, 0x0061'1011},
});

/// Value for the fastest known rate that is not above `bus_hz`; empty if all are above it.
[[nodiscard]] constexpr std::optional<std::uint32_t> i2c_timing(std::uint32_t kernel_hz,
                                                                std::uint32_t bus_hz) {
    std::optional<std::uint32_t> best;
    std::uint32_t best_hz = 0;
    for (const I2cTiming& timing : kI2cTimings) {
        if (timing.kernel_hz != kernel_hz || timing.bus_hz > bus_hz || timing.bus_hz < best_hz) continue;
        best = timing.timingr;
        best_hz = timing.bus_hz;
    }
    return best;
}

}  // namespace octoskin::stm32g4
