// Calibrating modelled parts: what is found, used as settings, brings the true range back. The model's optics
// and ST's formula are each other's check.
#include "firmware/drivers/vl53l1x/calibration.hpp"

#include <gtest/gtest.h>

#include "tests/support/vl53l1x/sensor_bench.hpp"

namespace octoskin::vl53l1x {
namespace {

constexpr Settings kSettings{.address = 0x30};
constexpr Microseconds kPeriod{33'000};  // of the settings

sim::RangingScene target_at(double range_m, double signal_mcps) {
    return [=](std::uint32_t, sim::SimTime, const Roi&) {
        return sim::RangingReturn{
            .range_m = range_m, .sigma_m = 0.003, .peak_signal_mcps = signal_mcps, .ambient_mcps = 0.1};
    };
}

/// A part that is brought up and stopped.
class Part {
  public:
    Part(const sim::RangingScene& scene, const sim::SensorPart& part, const Settings& settings = kSettings)
        : model(bench.add(scene, part)) {
        bench.bring_up(device, model, settings);
        device.begin_abort();
        EXPECT_EQ(bench.finish(device), Progress::done);
    }
    [[nodiscard]] Progress finish(CalibrationRun& run) {
        for (int polls = 0; polls < 10'000'000; ++polls) {
            const Progress progress = run.poll(bench.now());
            if (progress != Progress::busy) return progress;
            bench.wait(Microseconds{50});
        }
        return Progress::busy;
    }
    [[nodiscard]] int range_mm() {
        device.begin_start();
        EXPECT_EQ(bench.finish(device), Progress::done);
        EXPECT_TRUE(bench.await_measurement(device));
        return device.measurement().range_mm;
    }

    test::SensorBench bench;
    sim::SensorModel& model;
    Device device{bench.bus(), Options{}};
};

// The model's optics are 13 mm short of the truth, which the factory's offset mends.
TEST(OffsetCalibration, finds_what_the_factory_found) {
    Part part(target_at(0.140, 8.0), {});
    CalibrationRun run(part.device, kPeriod);
    run.begin_offset(140);
    ASSERT_EQ(part.finish(run), Progress::done);
    EXPECT_EQ(run.offset_quarter_mm(), 13 * 4);
    EXPECT_EQ(run.crosstalk_raw(), 0);
    EXPECT_EQ(part.bench.read(0x001E, 6, 0x30), (test::Bytes{0x00, 0x34, 0, 0, 0, 0}));
    EXPECT_EQ(part.range_mm(), 140);
    EXPECT_EQ(run.poll(part.bench.now()), Progress::idle);
}

TEST(OffsetCalibration, holds_for_a_part_configured_with_it) {
    for (const bool applies_gain_factor : {false, true}) {
        Settings settings = kSettings;
        settings.applies_gain_factor = applies_gain_factor;
        Part part(target_at(0.640, 8.0), {},
                  settings);  // 640 mm really are 600: 50 mm times 50 fit no 16 bits
        CalibrationRun run(part.device, kPeriod);
        run.begin_offset(600);
        ASSERT_EQ(part.finish(run), Progress::done);
        settings.has_offset = true;
        settings.offset_quarter_mm = run.offset_quarter_mm();
        Part again(target_at(0.640, 8.0), {}, settings);
        EXPECT_EQ(again.range_mm(), 600) << applies_gain_factor;
        EXPECT_EQ(run.offset_quarter_mm(), applies_gain_factor ? -65 : -108)
            << "-27 mm; (600 - 616) / 0.98193";
    }
}

TEST(OffsetCalibration, averages_to_a_quarter_of_a_millimetre) {
    // 146.0 and 147.0 in turn, less 13: the mean falls short of 140 by 6.5 mm.
    Part part([](std::uint32_t index, sim::SimTime time,
                 const Roi& roi) { return target_at(0.146 + 0.001 * (index % 2), 8.0)(index, time, roi); },
              {});
    CalibrationRun run(part.device, kPeriod);
    run.begin_offset(140);
    ASSERT_EQ(part.finish(run), Progress::done);
    EXPECT_EQ(run.offset_quarter_mm(), 26);
}

TEST(OffsetCalibration, that_fits_no_13_bits_is_refused_and_leaves_none) {
    for (const auto& [range_m, target_mm] :
         {std::pair{2.500, std::uint16_t{140}}, {0.140, std::uint16_t{2'500}}}) {
        Part part(target_at(range_m, 8.0), {});
        CalibrationRun run(part.device, kPeriod);
        run.begin_offset(target_mm);
        ASSERT_EQ(part.finish(run), Progress::failed);
        EXPECT_EQ(run.error(), CalibrationError::out_of_range);
        EXPECT_EQ(part.bench.read(0x001E, 2, 0x30), (test::Bytes{0, 0}));
    }
}

// 4 kcps of each of 204.8 SPADs in 4 Mcps: 20.48 % short.
TEST(CrosstalkCalibration, brings_the_true_range_back) {
    for (const double crosstalk_kcps : {0.5, 1.0, 4.0}) {
        Part part(target_at(0.600, 4.0), {.crosstalk_kcps = crosstalk_kcps});
        CalibrationRun run(part.device, kPeriod);
        run.begin_crosstalk(600);
        ASSERT_EQ(part.finish(run), Progress::done);
        EXPECT_NEAR(run.crosstalk_raw(), crosstalk_kcps * 512, 18.0) << "of 1 mm in 600, rounded";
        EXPECT_EQ(run.offset_quarter_mm(), 0);
        Settings settings = kSettings;
        settings.crosstalk_raw = run.crosstalk_raw();
        Part again(target_at(0.600, 4.0), {.crosstalk_kcps = crosstalk_kcps}, settings);
        EXPECT_NEAR(again.range_mm(), 600, 1);
        Part bare(target_at(0.600, 4.0), {.crosstalk_kcps = crosstalk_kcps});
        EXPECT_LT(bare.range_mm(), 600 * (1.0 - 0.05 * crosstalk_kcps) + 1);
    }
}

TEST(CrosstalkCalibration, ranges_too_long_make_none_and_too_much_is_refused) {
    Part far(target_at(0.700, 4.0), {});
    CalibrationRun long_run(far.device, kPeriod);
    long_run.begin_crosstalk(600);
    ASSERT_EQ(far.finish(long_run), Progress::done);
    EXPECT_EQ(long_run.crosstalk_raw(), 0);

    // Half of 60 Mcps of 204.8 SPADs are 146 kcps, beyond the 127 that a rig may have.
    Part near(target_at(0.300, 60.0), {});
    CalibrationRun short_run(near.device, kPeriod);
    short_run.begin_crosstalk(600);
    ASSERT_EQ(near.finish(short_run), Progress::failed);
    EXPECT_EQ(short_run.error(), CalibrationError::out_of_range);
    EXPECT_EQ(near.bench.read(0x0016, 2, 0x30), (test::Bytes{0, 0}));
}

TEST(Calibration, without_a_target_is_given_up) {
    Part part(test::empty_scene(), {});
    CalibrationRun run(part.device, kPeriod);
    run.begin_offset(140);
    ASSERT_EQ(part.finish(run), Progress::failed);
    EXPECT_EQ(run.error(), CalibrationError::no_target);
    EXPECT_EQ(part.model.history().size(), 13U) << "one of initialising, one without wrap check, eleven";
    EXPECT_EQ(part.bench.read(0x0087, 1, 0x30), test::Bytes{0x80});
}

TEST(Calibration, a_few_ranges_without_a_target_do_not_count) {
    Part part(
        [](std::uint32_t index, sim::SimTime time, const Roi& roi) {
            return index % 8 == 7 ? test::empty_scene()(index, time, roi)
                                  : target_at(0.140, 8.0)(index, time, roi);
        },
        {});
    CalibrationRun run(part.device, kPeriod);
    run.begin_offset(140);
    ASSERT_EQ(part.finish(run), Progress::done);
    EXPECT_EQ(run.offset_quarter_mm(), 13 * 4);
}

TEST(Calibration, of_a_silent_part_ends_after_two_seconds) {
    Part part(target_at(0.140, 8.0), {});
    part.model.set_faults({.never_ready = true});
    CalibrationRun run(part.device, kPeriod);
    const std::int64_t before_us = part.bench.time().us;
    run.begin_offset(140);
    ASSERT_EQ(part.finish(run), Progress::failed);
    EXPECT_EQ(run.error(), CalibrationError::no_result);
    EXPECT_NEAR(static_cast<double>(part.bench.time().us - before_us), 2e6, 10e3);
}

TEST(Calibration, ends_with_the_device_that_fails_at_any_time) {
    Part clean(target_at(0.140, 8.0), {});
    CalibrationRun whole(clean.device, kPeriod);
    whole.begin_crosstalk(140);
    const std::uint64_t before = clean.bench.bus().transfer_count();
    ASSERT_EQ(clean.finish(whole), Progress::done);
    const std::uint64_t transfers = clean.bench.bus().transfer_count() - before;
    for (std::uint64_t n = 0; n < transfers; n += n < 20 ? 1 : 97) {
        Part part(target_at(0.140, 8.0), {});
        part.bench.bus().inject({.kind = sim::I2cFaultKind::nack_address,
                                 .first = part.bench.bus().transfer_count() + n,
                                 .count = 1'000'000});
        CalibrationRun run(part.device, kPeriod);
        run.begin_crosstalk(140);
        ASSERT_EQ(part.finish(run), Progress::failed) << n;
        EXPECT_EQ(run.error(), CalibrationError::device) << n;
        EXPECT_EQ(part.device.error(), Error::no_answer) << n;
        EXPECT_EQ(run.crosstalk_raw(), 0) << n;
    }
}

TEST(Calibration, keeps_its_reason_if_the_part_cannot_even_be_stopped) {
    Part clean(test::empty_scene(), {});
    CalibrationRun whole(clean.device, kPeriod);
    whole.begin_offset(140);
    ASSERT_EQ(clean.finish(whole), Progress::failed);
    const std::uint64_t stop = clean.bench.bus().transfer_count() - 1;

    Part part(test::empty_scene(), {});
    part.bench.bus().inject({.kind = sim::I2cFaultKind::nack_address, .first = stop, .count = 2});
    CalibrationRun run(part.device, kPeriod);
    run.begin_offset(140);
    ASSERT_EQ(part.finish(run), Progress::failed);
    EXPECT_EQ(part.bench.bus().transfer_count(), stop + 2);
    EXPECT_EQ(run.error(), CalibrationError::no_target);
}

TEST(Calibration, impossible_targets_are_refused_before_anything_is_written) {
    for (const std::uint16_t target_mm : {std::uint16_t{0}, std::uint16_t{4'001}}) {
        Part part(target_at(0.140, 8.0), {});
        const std::uint64_t before = part.bench.bus().transfer_count();
        CalibrationRun run(part.device, kPeriod);
        run.begin_offset(target_mm);
        EXPECT_EQ(part.finish(run), Progress::failed);
        EXPECT_EQ(run.error(), CalibrationError::unsupported_target);
        EXPECT_EQ(part.bench.bus().transfer_count(), before);
        EXPECT_EQ(run.poll(part.bench.now()), Progress::idle);
    }
}

// Status 31 does not exist: such a block is a bus error read as data.
TEST(Calibration, drops_reads_that_make_no_sense_but_not_for_ever) {
    for (const bool lasts : {false, true}) {
        Part part(target_at(0.140, 8.0), {});
        CalibrationRun run(part.device, kPeriod);
        run.begin_offset(140);
        Progress progress = Progress::busy;
        for (int polls = 0; polls < 200'000 && progress == Progress::busy; ++polls) {
            progress = run.poll(part.bench.now());
            part.bench.wait(Microseconds{50});
            if (polls == 10'000) part.model.set_faults({.device_status = std::uint8_t{31}});
            if (polls == 11'000 && !lasts) part.model.set_faults({});  // 50 ms later: one or two ranges
        }
        EXPECT_EQ(progress, lasts ? Progress::failed : Progress::done);
        EXPECT_EQ(run.offset_quarter_mm(), lasts ? 0 : 13 * 4);
        if (lasts) {
            EXPECT_EQ(run.error(), CalibrationError::device);
            EXPECT_EQ(part.device.error(), Error::implausible_block);
        }
    }
}

TEST(Calibration, of_a_silent_slow_part_waits_three_periods) {
    Settings settings = kSettings;
    settings.inter_measurement_ms = 3'000;
    Part part(target_at(0.140, 8.0), {}, settings);
    part.model.set_faults({.never_ready = true});
    CalibrationRun run(part.device, Microseconds{3'000'000});
    const std::int64_t before_us = part.bench.time().us;
    run.begin_offset(140);
    ASSERT_EQ(part.finish(run), Progress::failed);
    EXPECT_EQ(run.error(), CalibrationError::no_result);
    EXPECT_NEAR(static_cast<double>(part.bench.time().us - before_us), 9e6, 10e3);
}

}  // namespace
}  // namespace octoskin::vl53l1x
