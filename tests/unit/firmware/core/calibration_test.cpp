// How a calibration's end is told. Calibrations as a whole: node_calibration_test.cpp.
#include "firmware/core/calibration.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string_view>

#include "tests/support/i2c/scripted_i2c_bus.hpp"

namespace octoskin::node {
namespace {

using vl53l1x::Progress;
using wire::CalibrationOutcome;

/// An offset calibration on a bus where the first transfers end so.
CalibrationResult offset_result(std::uint16_t target_mm, std::string_view script) {
    test::ScriptedI2cBus bus{script};
    vl53l1x::Device device{bus, {}};
    vl53l1x::CalibrationRun run{device, Microseconds{33'000}};
    run.begin_offset(target_mm);
    Progress progress = Progress::busy;
    NodeTime now{0};
    for (int polls = 0; polls < 100 && progress == Progress::busy; ++polls) {
        progress = run.poll(now);
        now = now + Microseconds{50};
    }
    EXPECT_EQ(progress, Progress::failed);
    return result_of(run, progress);
}

TEST(CalibrationResult, tells_a_part_that_failed_from_a_target_that_cannot_be) {
    EXPECT_EQ(offset_result(140, "W 001E 00 00 ! timeout | W 001E 00 00 ! timeout").outcome,
              CalibrationOutcome::device_failed);
    EXPECT_EQ(offset_result(0, "").outcome, CalibrationOutcome::refused);
    EXPECT_EQ(offset_result(4'001, "").outcome, CalibrationOutcome::refused);
}

}  // namespace
}  // namespace octoskin::node
