#include "firmware/core/sensor_fault.hpp"

namespace octoskin::node {

wire::SensorFault sensor_fault(vl53l1x::Error error) noexcept {
    using vl53l1x::Error;
    using wire::SensorFault;
    switch (error) {
        case Error::no_answer:
            return SensorFault::no_answer;
        case Error::bus_error:
            return SensorFault::bus_error;
        case Error::wrong_id:
            return SensorFault::wrong_id;
        case Error::boot_timeout:
            return SensorFault::boot_timeout;
        case Error::not_ready:
            return SensorFault::no_data_ready;
        case Error::unsupported_config:
        case Error::oscillator_zero:
        case Error::config_mismatch:
            return SensorFault::config_mismatch;
        case Error::reads_disagree:
            return SensorFault::reads_disagree;
        case Error::implausible_block:
            return SensorFault::implausible_block;
    }
    return SensorFault::bus_error;
}

}  // namespace octoskin::node
