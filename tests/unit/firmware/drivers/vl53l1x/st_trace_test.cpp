// The oracle is ST's own driver: with its options set, ours must put the same transfers on the bus, call by
// call.
#include <gtest/gtest.h>

#include "firmware/drivers/vl53l1x/device.hpp"
#include "tests/support/i2c/scripted_i2c_bus.hpp"
#include "tests/support/vl53l1x/st_trace.hpp"
#include "tests/unit/firmware/drivers/vl53l1x/operation.hpp"

namespace octoskin::vl53l1x {
namespace {

class StTrace : public testing::Test {
  protected:
    /// Runs the operation begun and expects exactly these transfers of it.
    void expect_done(const char* trace) {
        bus_.expect(trace);
        EXPECT_EQ(finish(device_, now_), Progress::done) << trace;
        EXPECT_TRUE(bus_.is_finished()) << trace;
    }
    void initialise() {
        device_.begin_load_configuration();
        bus_.expect(st::kSensorInit);
        EXPECT_EQ(finish(device_, now_), Progress::done);
        device_.begin_finish_initialise();
        EXPECT_EQ(finish(device_, now_), Progress::done);
        EXPECT_TRUE(bus_.is_finished());
    }

    test::ScriptedI2cBus bus_{""};
    Device device_{bus_, Options::as_st_uld()};
    NodeTime now_{};
};

TEST_F(StTrace, main_path_equals_st_call_by_call) {
    device_.begin_await_boot();
    expect_done(st::kBootState);
    device_.begin_probe(0x29);
    expect_done(st::kGetSensorId);
    initialise();
    device_.begin_set_distance_mode(DistanceMode::long_range);
    expect_done(st::kSetDistanceModeLong);
    device_.begin_set_timing_budget(33);
    expect_done(st::kSetTimingBudget33Long);
    device_.begin_set_inter_measurement(Microseconds{50'000});
    expect_done(st::kSetInterMeasurement50);
    device_.begin_start();
    expect_done(st::kStartRanging);

    device_.begin_read();
    expect_done(st::kNotReady);
    EXPECT_FALSE(device_.has_measurement());
    device_.begin_read();
    bus_.expect(st::kReady);
    bus_.expect(st::kGetResult);
    expect_done(st::kClearInterrupt);
    ASSERT_TRUE(device_.has_measurement());
    // The block of fixed registers decodes to 26 SPADs, 16.0 and 0.125 Mcps, 4.00 mm sigma, 1234 mm, 15.0
    // Mcps.
    const Measurement expected{.device_status = 9,
                               .stream_count = 5,
                               .effective_spads = 0x1A00,
                               .peak_signal = 0x0800,
                               .ambient = 0x0010,
                               .sigma_quarter_mm = 16,
                               .range_mm = 1234,
                               .corrected_signal = 0x0780};
    EXPECT_EQ(device_.measurement(), expected);

    device_.begin_read();
    expect_done(st::kNotReady);
    EXPECT_FALSE(device_.has_measurement());
    device_.begin_stop();
    expect_done(st::kStopRanging);
}

TEST_F(StTrace, short_mode_takes_the_budget_in_force_along) {
    device_.begin_set_distance_mode(DistanceMode::short_range);
    expect_done(st::kSetDistanceModeShort);
    device_.begin_set_timing_budget(20);
    expect_done(st::kSetTimingBudget20Short);
}

TEST_F(StTrace, period_is_read_back_with_the_oscillator) {
    bus_.expect(st::kGetInterMeasurement);
    device_.begin_read_register(0x006C, 4);
    EXPECT_EQ(finish(device_, now_), Progress::done);
    EXPECT_EQ(std::vector<std::uint8_t>(device_.register_bytes().begin(), device_.register_bytes().end()),
              (std::vector<std::uint8_t>{0x00, 0x00, 0x07, 0xC4}));
    device_.begin_read_register(0x00DE, 2);
    EXPECT_EQ(finish(device_, now_), Progress::done);
    EXPECT_EQ(device_.register_bytes().size(), 2U);
}

TEST_F(StTrace, region_of_interest) {
    device_.begin_set_roi_size(8, 8);
    expect_done(st::kSetRoi8x8);
    device_.begin_set_roi_centre(167);
    expect_done(st::kSetRoiCentre167);
}

TEST_F(StTrace, a_region_with_a_side_over_10_is_put_to_199) {
    device_.begin_set_roi_size(11, 4);
    expect_done("R 013E 1 -> C5 | W 007F C7 | W 0080 3A");
    device_.begin_set_roi_size(4, 11);
    expect_done("R 013E 1 -> C5 | W 007F C7 | W 0080 A3");
    device_.begin_set_roi_size(10, 10);
    expect_done("R 013E 1 -> C5 | W 007F C5 | W 0080 99");
}

TEST_F(StTrace, limits_offset_and_crosstalk) {
    device_.begin_set_offset(-13 * 4);
    expect_done(st::kSetOffsetMinus13);
    device_.begin_set_crosstalk(0x0400);
    expect_done(st::kSetXtalk2000);
    device_.begin_set_signal_limit(128);
    expect_done(st::kSetSignalThreshold1024);
    device_.begin_set_sigma_limit(60);
    expect_done(st::kSetSigmaThreshold15);
}

TEST_F(StTrace, interrupt_and_address) {
    device_.begin_set_range_threshold({.low_mm = 100, .high_mm = 300, .window = RangeWindow::inside});
    expect_done(st::kSetDistanceThreshold100To300Inside);
    device_.begin_set_interrupt_polarity(true);
    expect_done(st::kSetInterruptPolarityLow);
    device_.begin_set_address(0x2A);
    expect_done(st::kSetI2cAddress54);
    EXPECT_EQ(device_.live_address(), 0x2A);
}

TEST_F(StTrace, temperature_update) {
    device_.begin_update_temperature();
    expect_done(st::kStartTemperatureUpdate);
}

TEST_F(StTrace, configuring_is_the_sequence_of_its_calls) {
    initialise();
    Settings settings{.timing_budget_ms = 33, .inter_measurement_ms = 50};
    settings.offset_quarter_mm = -52;
    settings.has_offset = true;
    settings.crosstalk_raw = 0x0400;
    settings.sigma_limit_quarter_mm = 60;
    settings.signal_limit_raw = 128;
    settings.zones[0] = {.centre_spad = 167, .width = 8, .height = 8};
    device_.begin_configure(settings);
    for (const char* call : {st::kStopRanging, st::kSetDistanceModeLong, st::kSetTimingBudget33Long,
                             st::kSetInterMeasurement50, st::kSetRoi8x8, st::kSetRoiCentre167,
                             st::kSetSigmaThreshold15, st::kSetSignalThreshold1024, st::kSetOffsetMinus13}) {
        bus_.expect(call);
    }
    expect_done(st::kSetXtalk2000);
}

}  // namespace
}  // namespace octoskin::vl53l1x
