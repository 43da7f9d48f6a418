// The driver's errors as faults of the wire.
#pragma once

#include "common/wire/messages.hpp"
#include "firmware/drivers/vl53l1x/device.hpp"

namespace octoskin::node {

[[nodiscard]] wire::SensorFault sensor_fault(vl53l1x::Error error) noexcept;

}  // namespace octoskin::node
