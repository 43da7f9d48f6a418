// Where everything ends that must not happen: CAN falls silent, the cause is recorded, the chip is reset.
#pragma once

#include "firmware/port/stm32g4/fault_record.hpp"

namespace octoskin::stm32g4 {

/// The record of the last fault, in memory that resets leave alone.
[[nodiscard]] FaultRecord& fault_record();

[[noreturn]] void record_and_reset(const Fault& fault);

}  // namespace octoskin::stm32g4
