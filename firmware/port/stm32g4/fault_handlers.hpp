// Where everything ends that must not happen: CAN falls silent, the cause is recorded, the chip is reset.
#pragma once

#include "firmware/core/run_record.hpp"
#include "firmware/port/stm32g4/fault_record.hpp"

namespace octoskin::stm32g4 {

/// In memory that resets leave alone: the details of the last fault, and the core's record of its runs.
[[nodiscard]] FaultRecord& fault_record();
[[nodiscard]] node::KeptMemory& kept_memory();

[[noreturn]] void record_and_reset(const Fault& fault);

/// Whether reading the configuration page found a word that the flash itself calls damaged (a double error of
/// its check bits): a write or an erasure of the page was cut short. Whatever was read is not to be used.
[[nodiscard]] bool is_configuration_damaged();

}  // namespace octoskin::stm32g4
