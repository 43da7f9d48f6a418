// Error frames as <linux/can/error.h> defines them, bits written out here.
#include "firmware/port/linux/can_errors.hpp"

#include <gtest/gtest.h>

namespace octoskin::linux_port {
namespace {

using node::CanState;

wire::CanFrame error_frame(std::uint32_t classes, std::uint8_t controller = 0) {
    wire::CanFrame frame;
    frame.can_id = classes;
    frame.is_error = true;
    frame.payload_len = 8;
    frame.data[1] = controller;
    return frame;
}

TEST(CanErrors, tells_bus_off_from_every_state) {
    for (const CanState before : {CanState::active, CanState::passive, CanState::bus_off})
        EXPECT_EQ(state_after(error_frame(0x40), before), CanState::bus_off);
}

TEST(CanErrors, only_a_restart_ends_bus_off) {
    for (unsigned controller = 0; controller < 256; ++controller) {
        const auto frame = error_frame(0x04, static_cast<std::uint8_t>(controller));
        EXPECT_EQ(state_after(frame, CanState::bus_off), CanState::bus_off);
    }
    EXPECT_EQ(state_after(error_frame(0x100), CanState::bus_off), CanState::active);
}

TEST(CanErrors, tells_every_controller_status) {
    for (unsigned controller = 0; controller < 256; ++controller) {
        const auto frame = error_frame(0x04, static_cast<std::uint8_t>(controller));
        const bool is_passive = (controller & 0x30) != 0;                // receive or transmit
        const bool is_active = !is_passive && (controller & 0x4C) != 0;  // or at most a warning
        for (const CanState before : {CanState::active, CanState::passive}) {
            const CanState after = is_passive ? CanState::passive : is_active ? CanState::active : before;
            EXPECT_EQ(state_after(frame, before), after) << controller;
        }
    }
}

TEST(CanErrors, leaves_the_state_on_frames_about_something_else) {
    for (const std::uint32_t other : {0x01U, 0x02U, 0x08U, 0x10U, 0x20U, 0x80U, 0x200U})
        EXPECT_EQ(state_after(error_frame(other, 0x20), CanState::active), CanState::active) << other;
}

}  // namespace
}  // namespace octoskin::linux_port
