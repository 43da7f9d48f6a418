// REFLEX of the flashed image on a bus that is busy with what is less urgent.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/board/flashed_board.hpp"

namespace octoskin::sim::stm32 {
namespace {

// Heartbeats of others, back to back for 8 ms of every 10: below REFLEX, and above the node's readings.
TEST(ImageReflex, goes_out_within_5_ms_on_a_bus_that_is_busy_for_8_ms_of_10_with_what_is_less_urgent) {
    NodeConfig config = fleet(17, DistanceMode::short_range, 20, 33);
    config.uses_can_fd = false;
    config.nominal_bitrate = 500'000;
    for (std::size_t i = 0; i < 17; ++i) config.sensors.at(i).reflex_below_mm = 300;
    FlashedBoard board(config);
    node::CanTransmitter& others = board.bus().attach({}, 64);
    const wire::BitRates rates{.nominal = config.nominal_bitrate, .data = config.data_bitrate};
    const auto frame_us = frame_duration_us(wire::encode(wire::Heartbeat{}, 1), rates);
    for (int turn = 0; turn < 100; ++turn) {
        for (std::int64_t us = 0; us < 8'000; us += frame_us) {
            ASSERT_TRUE(others.send(
                wire::encode(wire::Heartbeat{}, static_cast<wire::NodeId>(1 + us / frame_us % 4))));
        }
        board.run_for(Microseconds{10'000});
    }
    ASSERT_EQ(board.reflexes().size(), 17U);
    for (const SaidReflex& said : board.reflexes()) {
        const auto& windows = board.windows(said.reflex.sensor);
        const auto after = std::ranges::lower_bound(windows, said.end);
        ASSERT_NE(after, windows.begin());
        // Half the budget of 20 ms after the middle of its window the range is ready.
        EXPECT_LE(said.end.us - (after - 1)->us, 10'000 + 5'000 + 1'000);
    }
    EXPECT_EQ(board.violations(), "");
}

}  // namespace
}  // namespace octoskin::sim::stm32
