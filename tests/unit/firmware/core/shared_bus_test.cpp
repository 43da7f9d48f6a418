#include "firmware/core/shared_bus.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/i2c/scripted_i2c_bus.hpp"

namespace octoskin::node {
namespace {

TEST(SharedBus, while_held_is_busy_for_whoever_would_begin_and_ends_what_is_in_flight) {
    test::ScriptedI2cBus bus{"R 010F 2 -> EA CC | W 0001 30 ! timeout"};
    SharedBus shared(bus);
    const std::array<std::uint8_t, 2> index = {0x01, 0x0F};
    std::array<std::uint8_t, 2> answer{};
    EXPECT_FALSE(shared.is_busy());
    shared.submit({0x29, index, answer}, {0}, {1'000});
    EXPECT_TRUE(shared.is_busy());
    shared.hold(true);
    EXPECT_EQ(shared.poll({100}), i2c::TransferState::done);
    EXPECT_EQ(answer, (std::array<std::uint8_t, 2>{0xEA, 0xCC}));
    EXPECT_FALSE(bus.is_busy());
    EXPECT_TRUE(shared.is_busy());
    shared.hold(false);
    EXPECT_FALSE(shared.is_busy());

    const std::array<std::uint8_t, 3> move = {0x00, 0x01, 0x30};
    shared.submit({0x29, move, {}}, {200}, {1'200});
    EXPECT_EQ(shared.poll({300}), i2c::TransferState::failed);
    EXPECT_EQ(shared.error(), i2c::TransferError::timeout);
}

TEST(SharedBus, recovers_the_bus_under_it) {
    test::ScriptedI2cBus bus{""};
    bus.expect("W 0001 30");
    SharedBus shared(bus);
    const std::array<std::uint8_t, 3> move = {0x00, 0x01, 0x30};
    shared.submit({0x29, move, {}}, {0}, {1'000});
    EXPECT_TRUE(shared.recover());
    EXPECT_FALSE(bus.is_busy());
    shared.submit({0x29, move, {}}, {100}, {1'100});
    EXPECT_EQ(shared.poll({200}), i2c::TransferState::done);
}

}  // namespace
}  // namespace octoskin::node
