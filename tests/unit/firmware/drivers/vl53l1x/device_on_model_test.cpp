// The driver on modelled sensors: what a node does, from XSHUT to measurements.
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "tests/support/vl53l1x/sensor_bench.hpp"

namespace octoskin::vl53l1x {
namespace {

constexpr Settings kSettings{.address = 0x30};

/// Runs the operations of several devices on one bus side by side.
[[nodiscard]] bool finish_all(test::SensorBench& bench, std::span<const std::unique_ptr<Device>> devices) {
    std::size_t ended = 0;
    for (int turn = 0; turn < 100'000 && ended < devices.size(); ++turn) {
        for (const auto& device : devices) {
            const Progress progress = device->poll(bench.now());
            if (progress == Progress::failed) return false;
            if (progress == Progress::done) ++ended;
        }
        bench.wait(Microseconds{20});
    }
    return ended == devices.size();
}

TEST(DeviceOnModel, measures_a_wall) {
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add(test::wall_at(1.234));
    Device device(bench.bus(), Options{});
    bench.bring_up(device, sensor, kSettings);
    ASSERT_TRUE(bench.await_measurement(device));
    const Measurement expected{.device_status = 9,
                               .stream_count = 0,
                               .effective_spads = 0xCCCD,
                               .peak_signal = 0x0800,
                               .ambient = 0x0010,
                               .sigma_quarter_mm = 20,
                               .range_mm = 1234,
                               .corrected_signal = 0x0800};
    EXPECT_EQ(device.measurement(), expected);
    EXPECT_EQ(device.i2c_error_count(), 0);
}

TEST(DeviceOnModel, fleet_on_one_bus_is_brought_up_one_by_one_and_ranges_at_once) {
    test::SensorBench bench;
    std::vector<sim::SensorModel*> sensors;
    std::vector<std::unique_ptr<Device>> devices;
    for (std::uint8_t i = 0; i < 5; ++i) {
        sensors.push_back(
            &bench.add(test::wall_at(0.5 + 0.1 * i), {.osc_calibrate = static_cast<std::uint16_t>(35 + i),
                                                      .slow_clock_factor = 1.04 + 0.01 * i,
                                                      .boot_time = Microseconds{800 + 100 * i}}));
        devices.push_back(std::make_unique<Device>(bench.bus(), Options{}));
    }
    for (std::uint8_t i = 0; i < 5; ++i) {
        bench.set_xshut(*sensors[i], true);
        bench.wait(Microseconds{2'000});
        devices[i]->begin_probe(kDefaultAddress);
        ASSERT_EQ(bench.finish(*devices[i]), Progress::done);
        devices[i]->begin_set_address(static_cast<i2c::Address>(0x30 + i));
        ASSERT_EQ(bench.finish(*devices[i]), Progress::done);
        Device watcher(bench.bus(), Options{});
        watcher.begin_probe(kDefaultAddress);
        ASSERT_EQ(bench.finish(watcher), Progress::failed) << "0x29 is free again";
        ASSERT_EQ(watcher.error(), Error::no_answer);
    }
    const sim::SimTime begin = bench.time();
    for (const auto& device : devices) device->begin_initialise();
    ASSERT_TRUE(finish_all(bench, devices));
    for (const auto& device : devices) device->begin_finish_initialise();
    ASSERT_TRUE(finish_all(bench, devices));
    EXPECT_LT(bench.time().us - begin.us, 150'000) << "one first range, not five";
    for (std::uint8_t i = 0; i < 5; ++i) {
        Settings settings = kSettings;
        settings.address = static_cast<i2c::Address>(0x30 + i);
        devices[i]->begin_configure(settings);
    }
    ASSERT_TRUE(finish_all(bench, devices));
    for (const auto& device : devices) device->begin_start();
    ASSERT_TRUE(finish_all(bench, devices));
    bench.wait(Microseconds{40'000});
    for (const auto& device : devices) device->begin_read();
    ASSERT_TRUE(finish_all(bench, devices));
    for (std::uint8_t i = 0; i < 5; ++i) {
        ASSERT_TRUE(devices[i]->has_measurement()) << int{i};
        EXPECT_EQ(devices[i]->measurement().range_mm, 500 + 100 * i);
        EXPECT_EQ(devices[i]->live_address(), 0x30 + i);
        EXPECT_EQ(devices[i]->i2c_error_count(), 0);
    }
}

// The model reports what the device's registers hold: the factor is the driver's to apply.
TEST(DeviceOnModel, gain_factor_is_applied_as_configured) {
    for (const bool applies : {false, true}) {
        Settings settings = kSettings;
        settings.applies_gain_factor = applies;
        test::SensorBench bench;
        sim::SensorModel& sensor = bench.add(test::wall_at(1.234));
        Device device(bench.bus(), Options{});
        bench.bring_up(device, sensor, settings);
        ASSERT_TRUE(bench.await_measurement(device));
        EXPECT_EQ(device.measurement().range_mm, applies ? 1212 : 1234);
        settings.applies_gain_factor = !applies;
        settings.timing_budget_ms = 1;
        device.begin_configure(settings);
        EXPECT_EQ(bench.finish(device), Progress::failed);
        bench.wait(Microseconds{50'000});
        ASSERT_TRUE(bench.await_measurement(device));
        EXPECT_EQ(device.measurement().range_mm, applies ? 1212 : 1234) << "refused settings change nothing";
    }
}

TEST(DeviceOnModel, every_mode_and_budget_ranges_at_the_period_asked_for) {
    for (const DistanceMode mode :
         {DistanceMode::short_range, DistanceMode::medium_range, DistanceMode::long_range}) {
        for (const std::uint16_t budget_ms :
             {std::uint16_t{15}, std::uint16_t{20}, std::uint16_t{33}, std::uint16_t{50}, std::uint16_t{100},
              std::uint16_t{200}, std::uint16_t{500}}) {
            Settings settings = kSettings;
            settings.distance_mode = mode;
            settings.timing_budget_ms = budget_ms;
            settings.inter_measurement_ms = static_cast<std::uint16_t>(budget_ms + 10);
            if (!is_supported(settings)) continue;
            test::SensorBench bench;
            sim::SensorModel& sensor = bench.add(test::wall_at(1.0), {.slow_clock_factor = 1.075});
            Device device(bench.bus(), Options{});
            bench.bring_up(device, sensor, settings);
            bench.wait(Microseconds{3'000 * (budget_ms + 10)});
            sensor.advance(bench.time());
            const auto& history = sensor.history();
            ASSERT_GE(history.size(), 3U);
            const double period_us =
                static_cast<double>(history.back().ready.us - history[history.size() - 2].ready.us);
            EXPECT_NEAR(period_us, (budget_ms + 10) * 1e3, 30.0);
            const std::int64_t half_us = history.back().ready.us - history.back().window_middle.us;
            EXPECT_NEAR(static_cast<double>(half_us), budget_ms * 500.0, budget_ms * 5.0);
        }
    }
}

// Without its second stop a part would range on, and one that a start does not restart would do so at times
// that nobody knows. Nobody documents which kind a real one is.
TEST(DeviceOnModel, first_ranges_when_it_is_started_whatever_write_was_lost_after_its_first_range) {
    constexpr std::uint64_t kTransfers = 8;  // more than there are
    for (const bool is_restarted : {true, false}) {
        for (std::uint64_t lost = 0; lost < kTransfers; ++lost) {
            SCOPED_TRACE(testing::Message()
                         << "transfer " << lost << ", restarted by a start: " << is_restarted);
            test::SensorBench bench;
            sim::SensorModel& sensor =
                bench.add_booted(test::wall_at(1.0), {.is_restarted_by_start = is_restarted});
            Device device(bench.bus(), Options{});
            device.begin_initialise();
            ASSERT_EQ(bench.finish(device), Progress::done);
            bench.wait(Microseconds{120'000});
            bench.bus().inject(
                {.kind = sim::I2cFaultKind::lose_write, .first = bench.bus().transfer_count() + lost});
            device.begin_finish_initialise();
            ASSERT_EQ(bench.finish(device), Progress::done);
            device.begin_configure(kSettings);
            ASSERT_EQ(bench.finish(device), Progress::done);
            bench.wait(Microseconds{17'000});
            device.begin_start();
            ASSERT_EQ(bench.finish(device), Progress::done);
            const std::int64_t started_us = bench.time().us;
            sensor.advance(bench.time());
            const std::size_t before = sensor.history().size();
            bench.wait(Microseconds{200'000});
            sensor.advance(bench.time());
            ASSERT_GT(sensor.history().size(), before);
            const auto took_us = static_cast<double>(sensor.history()[before].ready.us - started_us);
            EXPECT_NEAR(took_us, kSettings.inter_measurement_ms * 1e3, 1'500.0)
                << "the first ends a period after its start";
        }
    }
}

TEST(DeviceOnModel, a_reading_costs_470_bits_and_st_way_326) {
    for (const auto& [options, bits] : {std::pair{Options{}, 470U}, std::pair{Options::as_st_uld(), 326U}}) {
        test::SensorBench bench;
        sim::SensorModel& sensor = bench.add(test::wall_at(1.0));
        Device device(bench.bus(), options);
        bench.bring_up(device, sensor, kSettings);
        bench.wait(Microseconds{40'000});
        const std::uint64_t before = bench.bus().bit_count();
        device.begin_read();
        ASSERT_EQ(bench.finish(device), Progress::done);
        ASSERT_TRUE(device.has_measurement());
        EXPECT_EQ(bench.bus().bit_count() - before, bits);
    }
}

TEST(DeviceOnModel, ready_time_is_bracketed) {
    test::SensorBench bench(NodeTime{0xFFFF'0000});  // the node's clock wraps on the way
    sim::SensorModel& sensor = bench.add(test::wall_at(1.0));
    Device device(bench.bus(), Options{});
    bench.bring_up(device, sensor, kSettings);
    for (int reading = 0; reading < 20; ++reading) {
        ASSERT_TRUE(bench.await_measurement(device));
        ASSERT_TRUE(device.not_ready_seen());
        const NodeTime ready = NodeTime{0xFFFF'0000} + Microseconds{sensor.history().back().ready.us};
        EXPECT_GE(elapsed(*device.not_ready_seen(), ready).count(), 0);
        EXPECT_GE(elapsed(ready, device.ready_seen()).count(), 0);
        EXPECT_LT(elapsed(*device.not_ready_seen(), device.ready_seen()).count(), 1'000);
        EXPECT_EQ(device.measurement().stream_count, reading);
    }
}

TEST(DeviceOnModel, zone_changes_while_ranging_apply_from_the_next_range) {
    test::SensorBench bench;
    const auto scene = [](std::uint32_t, sim::SimTime, const Roi& roi) {
        return sim::RangingReturn{
            .range_m = roi.centre_spad * 1e-2, .sigma_m = 0.005, .peak_signal_mcps = 10.0};
    };
    sim::SensorModel& sensor = bench.add(scene);
    Device device(bench.bus(), Options{});
    Settings settings = kSettings;
    settings.zones[0] = {.centre_spad = 167, .width = 8, .height = 8};
    bench.bring_up(device, sensor, settings);
    ASSERT_TRUE(bench.await_measurement(device));
    EXPECT_EQ(device.measurement().range_mm, 1670);
    for (const std::uint8_t centre : {std::uint8_t{231}, std::uint8_t{163}, std::uint8_t{167}}) {
        device.begin_set_zone({.centre_spad = centre, .width = 8, .height = 8});
        ASSERT_EQ(bench.finish(device), Progress::done);
        ASSERT_TRUE(bench.await_measurement(device));
        EXPECT_EQ(device.measurement().range_mm, centre * 10);
        EXPECT_EQ(device.measurement().device_status, 9);
    }
}

TEST(DeviceOnModel, offset_is_added_by_the_device) {
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add(test::wall_at(1.0));
    Device device(bench.bus(), Options{});
    Settings settings = kSettings;
    settings.has_offset = true;
    settings.offset_quarter_mm = 52 + 40;  // the part's own is 13.0 mm
    bench.bring_up(device, sensor, settings);
    ASSERT_TRUE(bench.await_measurement(device));
    EXPECT_EQ(device.measurement().range_mm, 1010);
}

TEST(DeviceOnModel, single_shot_brings_one_measurement_with_stream_count_0) {
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add(test::wall_at(1.0));
    Device device(bench.bus(), Options{});
    bench.bring_up(device, sensor, kSettings);
    device.begin_abort();
    ASSERT_EQ(bench.finish(device), Progress::done);
    for (int shot = 0; shot < 3; ++shot) {
        device.begin_start_single();
        ASSERT_EQ(bench.finish(device), Progress::done);
        ASSERT_TRUE(bench.await_measurement(device, Microseconds{30'000}));
        EXPECT_EQ(device.measurement().stream_count, 0);
        EXPECT_FALSE(bench.await_measurement(device, Microseconds{100'000}));
    }
}

TEST(DeviceOnModel, one_more_result_may_come_after_a_stop) {
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add(test::wall_at(1.0));
    Device device(bench.bus(), Options{});
    bench.bring_up(device, sensor, kSettings);
    ASSERT_TRUE(bench.await_measurement(device));
    bench.wait(Microseconds{18'000});  // the next range is under way
    device.begin_stop();
    ASSERT_EQ(bench.finish(device), Progress::done);
    EXPECT_TRUE(bench.await_measurement(device, Microseconds{100'000}));
    EXPECT_FALSE(bench.await_measurement(device, Microseconds{100'000}));
}

TEST(DeviceOnModel, soft_reset_forgets_everything_whenever_the_part_forgets_its_address) {
    for (const bool forgets_at_once : {false, true}) {
        test::SensorBench bench;
        sim::SensorModel& sensor =
            bench.add(test::wall_at(1.0), {.forgets_address_as_soft_reset_begins = forgets_at_once});
        Device device(bench.bus(), Options{});
        bench.bring_up(device, sensor, kSettings);
        const std::int64_t before_us = bench.time().us;
        device.begin_soft_reset();
        ASSERT_EQ(bench.finish(device), Progress::done);
        EXPECT_LE(bench.time().us - before_us, 5'000);
        EXPECT_EQ(device.live_address(), kDefaultAddress);
        EXPECT_EQ(bench.read(0x0087, 1), test::Bytes{0x00});
        bench.bring_up(device, sensor, kSettings);
        EXPECT_TRUE(bench.await_measurement(device));
    }
}

// Whether results are gated too is not documented; the model goes on giving them.
TEST(DeviceOnModel, a_window_fires_only_for_ranges_inside_it) {
    double range_m = 1.0;
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add([&range_m](std::uint32_t index, sim::SimTime time, const Roi& roi) {
        return test::wall_at(range_m)(index, time, roi);
    });
    Device device(bench.bus(), Options{});
    bench.bring_up(device, sensor, kSettings);
    device.begin_set_range_threshold({.low_mm = 500, .high_mm = 800, .window = RangeWindow::inside});
    ASSERT_EQ(bench.finish(device), Progress::done);
    EXPECT_FALSE(bench.await_measurement(device, Microseconds{200'000}));
    range_m = 0.7;
    ASSERT_TRUE(bench.await_measurement(device, Microseconds{100'000}));
    EXPECT_EQ(device.measurement().range_mm, 700);
    range_m = 1.0;
    static_cast<void>(bench.await_measurement(device, Microseconds{50'000}));
    device.begin_set_interrupt_on_every_sample();
    ASSERT_EQ(bench.finish(device), Progress::done);
    EXPECT_TRUE(bench.await_measurement(device, Microseconds{100'000}));
}

TEST(DeviceOnModel, temperature_update_ends_stopped) {
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add(test::wall_at(1.0));
    Device device(bench.bus(), Options{});
    bench.bring_up(device, sensor, kSettings);
    device.begin_abort();
    ASSERT_EQ(bench.finish(device), Progress::done);
    device.begin_update_temperature();
    ASSERT_EQ(bench.finish(device), Progress::done);
    EXPECT_EQ(bench.read(0x0008, 1, 0x30), test::Bytes{0x09});
    EXPECT_EQ(bench.read(0x000B, 1, 0x30), test::Bytes{0x00});
    bench.wait(Microseconds{500'000});
    EXPECT_FALSE(bench.await_measurement(device, Microseconds{100'000}));
}

TEST(DeviceOnModel, status_of_every_code_survives_its_high_bits) {
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add(test::wall_at(1.0));
    Device device(bench.bus(), Options{});
    bench.bring_up(device, sensor, kSettings);
    for (unsigned status = 0; status < 256; ++status) {
        sensor.set_faults({.device_status = static_cast<std::uint8_t>(status)});
        const bool has_one = bench.await_measurement(device, Microseconds{100'000});
        if ((status & 0x1FU) <= 23) {
            ASSERT_TRUE(has_one) << status;
            EXPECT_EQ(device.measurement().device_status, status & 0x1FU);
        } else {
            ASSERT_FALSE(has_one) << status;
            EXPECT_EQ(device.error(), Error::implausible_block);
            sensor.set_faults({});
            bench.wait(Microseconds{40'000});
            ASSERT_TRUE(bench.await_measurement(device)) << "and it goes on";
        }
    }
}

TEST(DeviceOnModel, stream_count_wraps_to_128) {
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add(test::wall_at(1.0));
    Device device(bench.bus(), Options{});
    bench.bring_up(device, sensor, kSettings);
    for (unsigned reading = 0; reading < 400; ++reading) {
        ASSERT_TRUE(bench.await_measurement(device));
        const unsigned expected = reading < 256 ? reading : 128 + (reading - 256) % 128;
        ASSERT_EQ(device.measurement().stream_count, expected) << reading;
        bench.wait(Microseconds{30'000});
    }
}

// A result may come at any moment of a read: what is published is always one result, whole.
TEST(DeviceOnModel, never_publishes_a_mixture_of_two_results) {
    int read_again = 0;
    for (std::int64_t shift_us = 0; shift_us < 2'000; shift_us += 20) {
        test::SensorBench bench;
        sim::SensorModel& sensor = bench.add([](std::uint32_t index, sim::SimTime, const Roi&) {
            return sim::RangingReturn{
                .range_m = 0.1 + 0.1 * (index % 30), .sigma_m = 0.005, .peak_signal_mcps = 2.0 + index % 30};
        });
        Device device(bench.bus(), Options{});
        bench.bring_up(device, sensor, kSettings);
        bench.wait(Microseconds{40'000});  // one result is there, and not fetched
        sensor.advance(bench.time());
        const auto& history = sensor.history();
        const std::int64_t next_ready = history.back().ready.us + 33'300;
        bench.wait(Microseconds{next_ready - bench.time().us - 1'500 + shift_us});
        device.begin_read();
        const std::uint64_t before = bench.bus().transfer_count();
        ASSERT_EQ(bench.finish(device), Progress::done);
        ASSERT_TRUE(device.has_measurement());
        if (bench.bus().transfer_count() - before == 6) ++read_again;
        const Measurement& measured = device.measurement();
        const auto& truth = history[history.size() - 1].result.stream_count == measured.stream_count
                                ? history[history.size() - 1]
                                : history[history.size() - 2];
        EXPECT_EQ(measured.stream_count, truth.result.stream_count);
        EXPECT_EQ(measured.range_mm, truth.result.range_mm);
        EXPECT_EQ(measured.peak_signal, (2 + truth.index % 30) * 128);
    }
    EXPECT_GT(read_again, 10) << "for some shifts the result must change between the two reads";
}

}  // namespace
}  // namespace octoskin::vl53l1x
