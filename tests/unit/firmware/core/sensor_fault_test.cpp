#include "firmware/core/sensor_fault.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <set>
#include <utility>

namespace octoskin::node {
namespace {

using vl53l1x::Error;
using wire::SensorFault;

constexpr std::array<std::pair<Error, SensorFault>, 10> kNames{{
    {Error::no_answer, SensorFault::no_answer},
    {Error::bus_error, SensorFault::bus_error},
    {Error::wrong_id, SensorFault::wrong_id},
    {Error::boot_timeout, SensorFault::boot_timeout},
    {Error::not_ready, SensorFault::no_data_ready},
    // For all three the sensor cannot be set up as the rig file says.
    {Error::unsupported_config, SensorFault::config_mismatch},
    {Error::oscillator_zero, SensorFault::config_mismatch},
    {Error::config_mismatch, SensorFault::config_mismatch},
    {Error::reads_disagree, SensorFault::reads_disagree},
    {Error::implausible_block, SensorFault::implausible_block},
}};

TEST(SensorFault, names_each_error_of_the_driver) {
    std::set<Error> named;
    for (const auto& [error, fault] : kNames) {
        EXPECT_EQ(sensor_fault(error), fault) << static_cast<int>(error);
        named.insert(error);
    }
    EXPECT_EQ(named.size(), kNames.size());
}

TEST(SensorFault, is_never_none_whatever_the_value) {
    for (unsigned value = 0; value < 256; ++value) {
        const SensorFault fault = sensor_fault(static_cast<Error>(value));
        EXPECT_NE(fault, SensorFault::none) << value;
        if (value >= kNames.size()) {
            EXPECT_EQ(fault, SensorFault::bus_error) << value;
        }
    }
}

}  // namespace
}  // namespace octoskin::node
