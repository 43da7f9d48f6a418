// The flashed image and its XSHUT lines, behind the 74HC595 chain and on pins of their own.
#include <gtest/gtest.h>

#include "tests/board/image_fleets.hpp"

namespace octoskin::sim::stm32 {
namespace {

using namespace std::chrono_literals;

class ImageXshut : public testing::TestWithParam<XshutWiring> {
  protected:
    static constexpr std::uint8_t kSensors = 8;

    [[nodiscard]] std::size_t lines_high() {
        std::size_t count = 0;
        for (std::uint8_t i = 0; i < kSensors; ++i)
            count += flashed_.board().is_xshut_high(config_.sensors.at(i).xshut_line) ? 1U : 0U;
        return count;
    }
    [[nodiscard]] std::size_t lines_on_pins() const {
        return GetParam() == XshutWiring::chain ? 0 : GetParam() == XshutWiring::pins ? 8 : 4;
    }
    [[nodiscard]] std::uint64_t transfers() {
        std::uint64_t count = 0;
        for (std::size_t bus = 0; bus < 4; ++bus) count += flashed_.board().wire(bus).transfer_count();
        return count;
    }

    NodeConfig config_ = wired(fleet(kSensors, DistanceMode::short_range, 15, 20), GetParam());
    FlashedBoard flashed_{config_};
};

TEST_P(ImageXshut, eight_sensors_come_up_and_lose_nothing) {
    flashed_.run_for(3s);
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
        SCOPED_TRACE(testing::Message() << "sensor " << int{sensor});
        ASSERT_FALSE(flashed_.readings(sensor).empty());
        EXPECT_LE(flashed_.readings(sensor).front().end.us, 500'000);
        EXPECT_GE(flashed_.readings(sensor).back().end.us, 2'950'000);
        expect_unbroken(flashed_.readings(sensor));
    }
    EXPECT_EQ(flashed_.heartbeats().back().heartbeat.state, wire::NodeState::ranging);
    EXPECT_EQ(flashed_.violations(), "");
}

TEST_P(ImageXshut, only_sensors_on_pins_boot_before_the_image_starts) {
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
        const bool has_booted = flashed_.sensor(sensor).registers().at(reg::kModelId) == 0xEA;
        EXPECT_EQ(has_booted, config_.sensors.at(sensor).xshut_line >= 40) << int{sensor};
    }
}

// At power-on and after a reset: carriers with a pull-up let their sensors out while nobody drives the line.
TEST_P(ImageXshut, every_line_is_low_for_a_millisecond_before_anything_is_said) {
    for (int start = 0; start < 2; ++start) {
        SCOPED_TRACE(start);
        EXPECT_EQ(lines_high(), lines_on_pins()) << "of the chain the outputs are off";
        const std::uint64_t transfers_before = transfers();
        const std::size_t heartbeats_before = flashed_.heartbeats().size();
        for (int turn = 0; turn < 5'000 && lines_high() > 0; ++turn) flashed_.run_for(20us);
        const SimTime all_low = flashed_.now();
        EXPECT_EQ(flashed_.heartbeats().size(), heartbeats_before);
        for (int turn = 0; turn < 5'000 && transfers() == transfers_before; ++turn) {
            EXPECT_EQ(lines_high(), 0U);
            flashed_.run_for(20us);
        }
        EXPECT_GE(flashed_.now().us - all_low.us, 1'000);
        EXPECT_LE(flashed_.now().us - all_low.us, 50'000) << "it did begin";
        flashed_.run_for(1s);
        EXPECT_EQ(lines_high(), kSensors);
        flashed_.board().press_reset();
    }
}

INSTANTIATE_TEST_SUITE_P(Wirings, ImageXshut,
                         testing::Values(XshutWiring::chain, XshutWiring::pins, XshutWiring::both),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace octoskin::sim::stm32
