// Bit timing of the CAN controller for a bit rate. RM0440, "FDCAN bit timing"; CiA 601-3 for the sample
// points.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"
#include "firmware/port/stm32g4/registers/fdcan.hpp"

namespace octoskin::stm32g4 {

/// One bit is `1 + before + after` quanta of `prescaler` clocks each. The sample point lies between `before`
/// and `after`. The synchronisation jump width is `after`.
struct BitTiming {
    std::uint32_t prescaler = 1;
    std::uint32_t before = 1;  ///< TSEG1
    std::uint32_t after = 1;   ///< TSEG2

    [[nodiscard]] constexpr std::uint32_t quanta() const { return 1 + before + after; }
    friend constexpr bool operator==(const BitTiming&, const BitTiming&) = default;
};

/// Largest values that fit into the register's fields.
struct BitTimingRange {
    std::uint32_t prescaler_max = 1;
    std::uint32_t before_max = 1;
    std::uint32_t after_max = 1;
};
inline constexpr BitTimingRange kNominalRange{.prescaler_max = 512, .before_max = 256, .after_max = 128};
inline constexpr BitTimingRange kDataRange{.prescaler_max = 32, .before_max = 32, .after_max = 16};

/// With fewer quanta the sample point is too coarse.
inline constexpr std::uint32_t kQuantaMin = 8;

/// The timing with the most quanta that gives exactly `rate` from `clock_hz`, with its sample point as near
/// to `sample_permille` as the quanta allow. Empty if there is none.
[[nodiscard]] constexpr std::optional<BitTiming> bit_timing(std::uint32_t clock_hz, std::uint32_t rate,
                                                            std::uint32_t sample_permille,
                                                            const BitTimingRange& range) {
    if (rate == 0) return std::nullopt;
    for (std::uint32_t prescaler = 1; prescaler <= range.prescaler_max; ++prescaler) {
        if (clock_hz % (prescaler * rate) != 0) continue;
        const std::uint32_t quanta = clock_hz / (prescaler * rate);
        if (quanta < kQuantaMin) break;
        const std::uint32_t after =
            std::max<std::uint32_t>(1, (quanta * (1000 - sample_permille) + 500) / 1000);
        const std::uint32_t before = quanta - 1 - after;
        if (before <= range.before_max && after <= range.after_max) {
            return BitTiming{.prescaler = prescaler, .before = before, .after = after};
        }
    }
    return std::nullopt;
}

/// Long lines use low rates; there a late sample point leaves more time for the propagation delay.
[[nodiscard]] constexpr std::optional<BitTiming> nominal_timing(std::uint32_t clock_hz, std::uint32_t rate) {
    return bit_timing(clock_hz, rate, rate <= 250'000 ? 875 : 800, kNominalRange);
}
[[nodiscard]] constexpr std::optional<BitTiming> data_timing(std::uint32_t clock_hz, std::uint32_t rate) {
    return bit_timing(clock_hz, rate, 750, kDataRange);
}

/// Rates of a bus, in bit/s.
struct CanRates {
    std::uint32_t nominal = 0;
    std::uint32_t data = 0;
    bool has_fd = false;  ///< if false, `data` is not used
    friend constexpr auto operator<=>(const CanRates&, const CanRates&) = default;
};
[[nodiscard]] constexpr CanRates rates_of(const NodeConfig& config) {
    return {.nominal = config.nominal_bitrate, .data = config.data_bitrate, .has_fd = config.uses_can_fd};
}
[[nodiscard]] constexpr bool is_possible(const CanRates& rates, std::uint32_t clock_hz) {
    return nominal_timing(clock_hz, rates.nominal) && (!rates.has_fd || data_timing(clock_hz, rates.data));
}

[[nodiscard]] constexpr std::uint32_t nbtp(const BitTiming& timing) {
    using F = Field<FdcanMap>;
    return F("NBTP.NSJW")(timing.after - 1) | F("NBTP.NBRP")(timing.prescaler - 1) |
           F("NBTP.NTSEG1")(timing.before - 1) | F("NBTP.NTSEG2")(timing.after - 1);
}

/// At 2 Mbit/s and above, the transceiver's delay exceeds the data sample point: the controller measures and
/// compensates it. It can do so with a prescaler of 1 or 2.
[[nodiscard]] constexpr bool is_delay_compensated(std::uint32_t rate, const BitTiming& timing) {
    return rate >= 2'000'000 && timing.prescaler <= 2;
}
[[nodiscard]] constexpr std::uint32_t dbtp(std::uint32_t rate, const BitTiming& timing) {
    using F = Field<FdcanMap>;
    return F("DBTP.TDC")(is_delay_compensated(rate, timing) ? 1 : 0) | F("DBTP.DBRP")(timing.prescaler - 1) |
           F("DBTP.DTSEG1")(timing.before - 1) | F("DBTP.DTSEG2")(timing.after - 1) |
           F("DBTP.DSJW")(timing.after - 1);
}
/// The compensated sample point, in clocks after the measured delay.
[[nodiscard]] constexpr std::uint32_t tdcr(const BitTiming& timing) {
    return Field<FdcanMap>("TDCR.TDCO")(timing.prescaler * (1 + timing.before));
}

}  // namespace octoskin::stm32g4
