// Errors of the driver, and the choices of a board or a policy.
#pragma once

#include <cstdint>

#include "firmware/drivers/vl53l1x/verification.hpp"

namespace octoskin::vl53l1x {

enum class Error : std::uint8_t {
    no_answer,           ///< address not acknowledged, after one retry
    bus_error,           ///< data NACK, time-out or held line, after one retry; or the bus stayed busy
    wrong_id,            ///< 0x010F..0x0110 is not 0xEACC
    boot_timeout,        ///< FIRMWARE__SYSTEM_STATUS bit 0 not set within 500 ms
    not_ready,           ///< no data ready at the deadline of the wait
    unsupported_config,  ///< budget not allowed for the mode, period < budget + 5 ms, ROI that does not fit,
                         ///< limits
    oscillator_zero,     ///< RESULT__OSC_CALIBRATE_VAL reads 0: the period cannot be set
    reads_disagree,      ///< two reads of the result block, or of the oscillator value, differ
    implausible_block,   ///< all 0xFF or impossible fields: a bus error read as data
    config_mismatch,     ///< read-back differs from what was written
};

/// Choices that depend on the board or on a policy. `Options::as_st_uld()` gives the transfers of ST's own
/// driver.
struct Options {
    bool is_io_2v8 = true;                  ///< 0x2E, 0x2F
    bool is_interrupt_active_low = true;    ///< 0x30 bit 4
    bool writes_config_in_burst = true;     ///< 91 bytes in one transfer rather than 91 transfers
    bool reads_twice = true;                ///< the result block and the oscillator value
    bool reads_factory_offset = true;       ///< read twice, before any write except that of the address
    bool caches_polarity = true;            ///< false: 0x30 is read before every 0x31, as ST's driver does
    bool clears_before_start = true;        ///< write 0x86 before 0x87 = 0x40
    bool verifies_address = true;           ///< the identification is read at the new address
    bool rereads_settings = false;          ///< mode and budget are read back before each dependent setting
    std::uint32_t i2c_hz = 400'000;         ///< for the deadline of a transfer: 3 x nominal time + lateness
    std::uint32_t i2c_lateness_us = 1'000;  ///< delay after which a port detects the end of a transfer
    /// Differences that the read-back ignores; must outlive the devices.
    const Verification* verification = &kWholeVerification;
    [[nodiscard]] static constexpr Options as_st_uld() noexcept {
        return {.is_io_2v8 = false,
                .is_interrupt_active_low = false,
                .writes_config_in_burst = false,
                .reads_twice = false,
                .reads_factory_offset = false,
                .caches_polarity = false,
                .clears_before_start = false,
                .verifies_address = false,
                .rereads_settings = true,
                .i2c_hz = 400'000,
                .i2c_lateness_us = 1'000,
                .verification = &kWholeVerification};
    }
};

}  // namespace octoskin::vl53l1x
