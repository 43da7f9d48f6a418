// Handling of fatal errors: CAN falls silent, the cause is recorded, the chip is reset.
#pragma once

#include "firmware/core/run_record.hpp"
#include "firmware/port/stm32g4/fault_record.hpp"

namespace octoskin::stm32g4 {

/// In memory that a reset does not clear: the details of the last fault, and the core's record of its runs.
[[nodiscard]] FaultRecord& fault_record();
[[nodiscard]] node::KeptMemory& kept_memory();

[[noreturn]] void record_and_reset(const Fault& fault);

/// Whether a read of the configuration page met a double bit error: a write or an erasure of the page was
/// interrupted. The data read must not be used.
[[nodiscard]] bool is_configuration_damaged();

}  // namespace octoskin::stm32g4
