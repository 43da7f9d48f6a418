// The driver with its own options on a scripted bus.
#pragma once

#include <gtest/gtest.h>

#include "firmware/drivers/vl53l1x/device.hpp"
#include "tests/support/i2c/scripted_i2c_bus.hpp"
#include "tests/unit/firmware/drivers/vl53l1x/operation.hpp"

namespace octoskin::vl53l1x {

class DeviceOnScript : public testing::Test {
  protected:
    void expect_done(const char* trace) {
        bus_.expect(trace);
        EXPECT_EQ(finish(device_, now_), Progress::done) << trace;
        EXPECT_TRUE(bus_.is_finished()) << trace;
    }
    void expect_failed(Error error, const char* trace) {
        bus_.expect(trace);
        EXPECT_EQ(finish(device_, now_), Progress::failed) << trace;
        EXPECT_EQ(device_.error(), error) << trace;
        EXPECT_TRUE(bus_.is_finished()) << trace;
    }
    /// The state after the default configuration, without its transfers.
    void load_configuration() {
        device_.begin_load_configuration();
        bus_.expect(kBurst);
        expect_done("W 0086 01 | W 0087 40");
    }

    // ST's 91 bytes; ours are 2E, 2F (2.8 V) and 30 (active low).
    static constexpr const char* kBurst =
        "W 002D 00 01 01 11 02 00 02 08 00 08 10 01 01 00 00 00 00 FF 00 0F 00 00 00 00 00 20 0B 00 00 02 0A "
        "21 00 "
        "00 05 00 00 00 00 C8 00 00 38 FF 01 00 08 00 00 01 CC 0F 01 F1 0D 01 68 00 80 08 B8 00 00 00 00 0F "
        "89 00 "
        "00 00 00 00 00 00 01 0F 0D 0E 0E 00 00 02 C7 FF 9B 00 00 00 01 00 00";

    test::ScriptedI2cBus bus_{""};
    Device device_{bus_, Options{}};
    NodeTime now_{};
};

}  // namespace octoskin::vl53l1x
