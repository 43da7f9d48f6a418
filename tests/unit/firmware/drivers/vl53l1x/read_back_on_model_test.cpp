// The driver's read-back on modelled sensors: whatever a bus does to one write of a bring-up, a configuration
// that differs is never taken for good.
#include <gtest/gtest.h>

#include "tests/support/vl53l1x/sensor_bench.hpp"

namespace octoskin::vl53l1x {
namespace {

using sim::I2cFault;
using sim::I2cFaultKind;

constexpr Settings kSettings{.address = 0x30,
                             .offset_quarter_mm = -20,
                             .has_offset = true,
                             .crosstalk_raw = 700,
                             .zones = {Roi{.centre_spad = 167, .width = 8, .height = 8}}};

/// A sensor brought up to where it is configured, with a fault in one of the bus's transfers.
class Sensor {
  public:
    explicit Sensor(const Settings& settings = kSettings) : settings_(settings) {
        bench_.set_xshut(model_, true);
        bench_.wait(Microseconds{2'000});
    }
    void inject(const I2cFault& fault) { bench_.bus().inject(fault); }

    [[nodiscard]] Progress run(void (*begin)(Device&, const Settings&)) {
        begin(device_, settings_);
        return bench_.finish(device_);
    }
    /// False as soon as an operation fails.
    [[nodiscard]] bool configure() {
        return run([](Device& d, const Settings& s) { d.begin_set_address(s.address); }) == Progress::done &&
               run([](Device& d, const Settings&) { d.begin_initialise(); }) == Progress::done &&
               run([](Device& d, const Settings&) { d.begin_finish_initialise(); }) == Progress::done &&
               run([](Device& d, const Settings& s) { d.begin_configure(s); }) == Progress::done;
    }
    [[nodiscard]] bool verify(std::size_t run) {
        device_.begin_verify(run);
        const Progress progress = bench_.finish(device_);
        if (progress == Progress::failed) {
            EXPECT_EQ(device_.error(), Error::config_mismatch);
        }
        return progress == Progress::done;
    }
    /// All of it, whatever the first run says.
    [[nodiscard]] bool verify() {
        bool is_right = true;
        for (std::size_t run = 0; run < kRegisterRuns.size(); ++run) is_right &= verify(run);
        return is_right;
    }
    [[nodiscard]] const sim::Registers& registers() const { return model_.registers(); }
    sim::SensorModel& model() { return model_; }
    Device& device() { return device_; }
    test::SensorBench& bench() { return bench_; }

  private:
    Settings settings_;
    test::SensorBench bench_;
    sim::SensorModel& model_ = bench_.add(test::wall_at(1.0));
    Device device_{bench_.bus(), Options{}};
};

/// The bits that the driver sets: 0x09 and 0x0A it never writes, the VHV start value is the sensor's own, and
/// some bits of the pads do nothing.
unsigned bits_that_matter(std::size_t index) {
    switch (index) {
        case 0x09:
        case 0x0A:
            return 0x00;
        case 0x0B:
            return 0x80;
        case 0x2E:
            return 0x01;
        case 0x2F:
            return 0x03;
        case 0x30:
            return 0x1F;
        default:
            return 0xFF;
    }
}

/// What the driver reads back, as the sensor should hold it.
bool is_as_configured(const sim::Registers& registers, const sim::Registers& good) {
    for (const RegisterRun& run : kRegisterRuns) {
        for (std::size_t i = run.first; i < std::size_t{run.first} + run.count; ++i) {
            if (((registers.at(i) ^ good.at(i)) & bits_that_matter(i)) != 0) return false;
        }
    }
    return true;
}

TEST(ReadBackOnModel, clean_configuration_agrees_for_every_mode) {
    for (const DistanceMode mode :
         {DistanceMode::short_range, DistanceMode::medium_range, DistanceMode::long_range}) {
        for (const bool has_offset : {false, true}) {
            Settings settings = kSettings;
            settings.distance_mode = mode;
            settings.timing_budget_ms = 33;
            settings.inter_measurement_ms = 50;
            settings.has_offset = has_offset;
            Sensor sensor(settings);
            ASSERT_TRUE(sensor.configure());
            EXPECT_TRUE(sensor.verify());
            EXPECT_EQ(sensor.device().i2c_error_count(), 0);
        }
    }
}

TEST(ReadBackOnModel, st_order_of_single_writes_agrees_too) {
    test::SensorBench bench;
    bench.add_booted(test::wall_at(1.0));
    Device device(bench.bus(), Options::as_st_uld());
    device.begin_initialise();
    ASSERT_EQ(bench.finish(device), Progress::done);
    for (std::size_t run = 0; run < kRegisterRuns.size(); ++run) {
        device.begin_verify(run);
        EXPECT_EQ(bench.finish(device), Progress::done) << run;
    }
}

/// Bring-up under one fault: either it fails, or the read-back does, or nothing was altered.
::testing::AssertionResult is_caught(const I2cFault& fault, const sim::Registers& good) {
    Sensor sensor;
    sensor.inject(fault);
    if (!sensor.configure() || !sensor.verify()) return ::testing::AssertionSuccess();
    if (is_as_configured(sensor.registers(), good)) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "fault " << static_cast<int>(fault.kind) << " of transfer "
                                         << fault.first << ", bit " << fault.position;
}

TEST(ReadBackOnModel, no_lost_write_of_a_bring_up_goes_unseen) {
    Sensor clean;
    ASSERT_TRUE(clean.configure());
    const std::uint64_t transfers = clean.bench().bus().transfer_count();
    for (std::uint64_t i = 0; i < transfers; ++i)
        EXPECT_TRUE(is_caught({.kind = I2cFaultKind::lose_write, .first = i}, clean.registers()));
}

TEST(ReadBackOnModel, no_flipped_bit_of_a_write_of_a_bring_up_goes_unseen) {
    Sensor clean;
    ASSERT_TRUE(clean.configure());
    const std::uint64_t transfers = clean.bench().bus().transfer_count();
    for (std::uint64_t i = 0; i < transfers; ++i) {
        for (std::uint32_t bit = 0; bit < 6 * 8; ++bit) {
            EXPECT_TRUE(is_caught({.kind = I2cFaultKind::flip_written_bit, .first = i, .position = bit},
                                  clean.registers()));
        }
    }
    // The burst: id, address and its check, boot come before.
    for (std::uint32_t bit = 0; bit < 93 * 8; ++bit) {
        EXPECT_TRUE(is_caught({.kind = I2cFaultKind::flip_written_bit, .first = 3, .position = bit},
                              clean.registers()));
    }
}

TEST(ReadBackOnModel, a_bit_that_flips_on_its_way_back_is_read_again) {
    Sensor probe;
    ASSERT_TRUE(probe.configure());
    const std::uint64_t before = probe.bench().bus().transfer_count();
    for (std::uint64_t i = 0; i < kRegisterRuns.size(); ++i) {
        Sensor sensor;
        sensor.inject({.kind = I2cFaultKind::flip_bit, .first = before + i, .position = 6});
        ASSERT_TRUE(sensor.configure());
        EXPECT_TRUE(sensor.verify()) << i;
        EXPECT_EQ(sensor.device().i2c_error_count(), 1) << i;
        EXPECT_EQ(sensor.device().read_back().last_difference(), std::nullopt);
    }
}

TEST(ReadBackOnModel, every_steering_register_altered_later_is_found_in_its_group) {
    for (std::size_t group = 0; group < kSteeringGroups; ++group) {
        const RegisterRun& run = kRegisterRuns[group];
        for (std::size_t i = 0; i < run.count; ++i) {
            for (unsigned bit = 1; bit <= 0x80; bit <<= 1U) {
                Sensor sensor;
                ASSERT_TRUE(sensor.configure());
                ASSERT_TRUE(sensor.verify());
                const auto index = static_cast<std::uint16_t>(run.first + i);
                const std::uint8_t before = sensor.registers().at(index);
                sensor.model().alter_register(index, static_cast<std::uint8_t>(before ^ bit));
                for (std::size_t other = 0; other < kSteeringGroups; ++other)
                    EXPECT_EQ(sensor.verify(other), other != group) << index;
                const RegisterDifference expected{
                    .index = index, .expected = before, .found = static_cast<std::uint8_t>(before ^ bit)};
                EXPECT_EQ(sensor.device().read_back().last_difference(), expected);
            }
        }
    }
}

TEST(ReadBackOnModel, zone_and_period_written_later_are_what_is_expected) {
    Sensor sensor;
    ASSERT_TRUE(sensor.configure());
    ASSERT_TRUE(sensor.run([](Device& d, const Settings&) { d.begin_start(); }) == Progress::done);
    ASSERT_TRUE(sensor.run([](Device& d, const Settings&) {
        d.begin_set_zone({.centre_spad = 199, .width = 16, .height = 16});
    }) == Progress::done);
    ASSERT_TRUE(sensor.run([](Device& d, const Settings&) {
        d.begin_set_inter_measurement(Microseconds{41'234});
    }) == Progress::done);
    EXPECT_TRUE(sensor.verify(2));
    EXPECT_TRUE(sensor.verify());
}

// A part whose register is stuck: the third attempt takes it as it is.
TEST(ReadBackOnModel, a_stuck_register_is_exempt_after_two_more_attempts) {
    Sensor sensor;
    sensor.model().set_faults({.stuck_register = sim::StuckRegister{.index = 0x4C, .value = 0x20}});
    for (int attempt = 1; attempt <= 4; ++attempt) {
        sensor.bench().set_xshut(sensor.model(), false);
        sensor.bench().wait(Microseconds{1'000});
        sensor.bench().set_xshut(sensor.model(), true);
        sensor.bench().wait(Microseconds{2'000});
        ASSERT_EQ(sensor.run([](Device& d, const Settings&) { d.begin_probe(kDefaultAddress); }),
                  Progress::done);
        ASSERT_TRUE(sensor.configure());
        EXPECT_EQ(sensor.verify(), attempt >= 3) << attempt;
    }
    const RegisterDifference expected{.index = 0x4C, .expected = 0x21, .found = 0x20};
    EXPECT_EQ(sensor.device().read_back().fixed_register(), expected);
    EXPECT_EQ(sensor.device().read_back().exempt_count(), 1);
}

}  // namespace
}  // namespace octoskin::vl53l1x
