// Bring-up and settings, transfer by transfer, against a script.
#include <gtest/gtest.h>

#include "tests/unit/firmware/drivers/vl53l1x/device_on_script.hpp"

namespace octoskin::vl53l1x {
namespace {

using i2c::TransferError;

// --- bring-up

TEST_F(DeviceOnScript, probes_and_moves_an_address) {
    device_.begin_probe(0x29);
    expect_done("R 010F 2 -> EA CC");
    EXPECT_EQ(device_.live_address(), 0x29);
    device_.begin_set_address(0x30);
    expect_done("W 0001 30 | ADDRESS 30 | R 010F 2 -> EA CC");
    EXPECT_EQ(device_.live_address(), 0x30);
}

TEST_F(DeviceOnScript, st_headers_misprinted_id_is_a_wrong_id) {
    device_.begin_probe(0x29);
    expect_failed(Error::wrong_id, "R 010F 2 -> EE AC");
}

TEST_F(DeviceOnScript, soft_reset_ends_at_the_default_address) {
    device_.begin_set_address(0x2A);
    bus_.expect("W 0001 2A");
    expect_done("ADDRESS 2A | R 010F 2 -> EA CC");
    device_.begin_soft_reset();
    bus_.expect("ADDRESS 2A | W 0000 00 | W 0000 01");
    // It boots: nobody acknowledges, and that is no error.
    bus_.expect_failure("R 00E5 1 -> 00", TransferError::nack_address);
    bus_.expect_failure("R 00E5 1 -> 00", TransferError::nack_address);
    bus_.expect_failure("R 00E5 1 -> 00", TransferError::nack_address);
    bus_.expect("R 00E5 1 -> 02");
    expect_done("R 00E5 1 -> 03 | R 010F 2 -> EA CC");
    EXPECT_EQ(device_.live_address(), kDefaultAddress);
    EXPECT_EQ(device_.i2c_error_count(), 0);
}

TEST_F(DeviceOnScript, soft_reset_without_anybody_is_told) {
    device_.begin_probe(0x2A);
    expect_done("ADDRESS 2A | R 010F 2 -> EA CC");
    device_.begin_soft_reset();
    bus_.expect("ADDRESS 2A | W 0000 00");
    for (const char* address : {"ADDRESS 2A | W 0000 01", "W 0000 01"}) {
        bus_.expect_failure(address, TransferError::nack_address);
        bus_.expect_failure(address, TransferError::nack_address);
    }
    expect_failed(Error::no_answer, "");
}

TEST_F(DeviceOnScript, address_stays_the_old_one_until_the_new_one_is_acknowledged) {
    device_.begin_set_address(0x30);
    bus_.expect_failure("W 0001 30 | W 0001 30", TransferError::nack_data);
    EXPECT_EQ(finish(device_, now_), Progress::failed);
    EXPECT_EQ(device_.live_address(), 0x29);
}

TEST_F(DeviceOnScript, new_address_that_does_not_answer_is_told) {
    device_.begin_set_address(0x30);
    bus_.expect("W 0001 30");
    bus_.expect_failure("ADDRESS 30 | R 010F 2 -> 00 00 | R 010F 2 -> 00 00", TransferError::nack_address);
    EXPECT_EQ(finish(device_, now_), Progress::failed);
    EXPECT_EQ(device_.error(), Error::no_answer);
    EXPECT_EQ(device_.live_address(), 0x30);
}

TEST_F(DeviceOnScript, initialises_in_one_burst_once_booted) {
    device_.begin_initialise();
    bus_.expect("R 00E5 1 -> 00 | R 00E5 1 -> 02 | R 00E5 1 -> 03");
    bus_.expect("R 001E 6 -> 00 34 00 28 00 0D | R 001E 6 -> 00 34 00 28 00 0D");
    bus_.expect(kBurst);
    expect_done("W 0086 01 | W 0087 40");
    device_.begin_finish_initialise();
    expect_done("R 0031 1 -> 03 | R 0031 1 -> 02 | W 0086 01 | W 0087 00 | W 0008 09 | W 000B 00");
}

TEST_F(DeviceOnScript, writes_nothing_to_a_part_whose_factory_offset_does_not_read_twice_alike) {
    device_.begin_initialise();
    bus_.expect("R 00E5 1 -> 03 | R 001E 6 -> 00 34 00 28 00 0D | R 001E 6 -> 00 34 00 28 00 1D");
    EXPECT_EQ(finish(device_, now_), Progress::failed);
    EXPECT_EQ(device_.error(), Error::reads_disagree);
}

TEST_F(DeviceOnScript, polls_boot_and_the_first_range_every_millisecond) {
    bus_.expect("R 00E5 1 -> 00");
    device_.begin_await_boot();
    EXPECT_EQ(device_.poll({0}), Progress::busy);
    EXPECT_EQ(device_.wake_time(), std::nullopt) << "its transfer is in flight";
    EXPECT_EQ(device_.poll({120}), Progress::busy);
    EXPECT_EQ(device_.wake_time(), NodeTime{1'120});
    EXPECT_EQ(device_.poll({1'119}), Progress::busy);
    EXPECT_FALSE(bus_.is_busy());
    bus_.expect("R 00E5 1 -> 01");
    EXPECT_EQ(device_.poll({1'120}), Progress::busy);
    EXPECT_TRUE(bus_.is_busy());
    EXPECT_EQ(device_.poll({1'240}), Progress::done);
    EXPECT_EQ(device_.poll({1'241}), Progress::idle) << "an end is told once";

    bus_.expect("R 0031 1 -> 03 | R 0031 1 -> 03");
    device_.begin_finish_initialise();
    EXPECT_EQ(device_.poll({2'000}), Progress::busy);
    EXPECT_EQ(device_.poll({2'120}), Progress::busy);
    EXPECT_EQ(device_.wake_time(), NodeTime{3'120});
    EXPECT_EQ(device_.poll({3'120}), Progress::busy);
    EXPECT_EQ(device_.poll({3'240}), Progress::busy);
}

// --- settings

TEST_F(DeviceOnScript, configures_without_reading_back) {
    load_configuration();
    Settings settings{.distance_mode = DistanceMode::medium_range};
    settings.timing_budget_ms = 33;
    settings.inter_measurement_ms = 50;
    settings.zones[0] = {.centre_spad = 167, .width = 8, .height = 8};
    device_.begin_configure(settings);
    expect_done(R"(
        W 0087 00
        W 004B 0E | W 0060 0B | W 0063 09 | W 0069 78 | W 0078 0B 09 | W 007A 0A 0A
        W 005E 00 80 | W 0061 00 9A
        R 00DE 2 -> 00 25 | R 00DE 2 -> 00 25 | W 006C 00 00 07 C4
        W 007F A7 77
        W 0064 01 68 | W 0066 00 80
        W 0018 00 00 | W 001A 00 00 | W 0016 00 00)");
}

TEST_F(DeviceOnScript, writes_the_offset_only_if_there_is_one) {
    load_configuration();
    Settings settings;
    settings.has_offset = true;
    settings.offset_quarter_mm = 37;
    device_.begin_configure(settings);
    expect_done(R"(
        W 0087 00
        W 004B 0A | W 0060 0F | W 0063 0D | W 0069 B8 | W 0078 0F 0D | W 007A 0E 0E
        W 005E 00 1E | W 0061 00 22
        R 00DE 2 -> 00 25 | R 00DE 2 -> 00 25 | W 006C 00 00 05 20
        W 007F C7
        W 0064 01 68 | W 0066 00 80
        W 001E 00 25 | W 0020 00 00 | W 0022 00 00
        W 0018 00 00 | W 001A 00 00 | W 0016 00 00)");
}

TEST_F(DeviceOnScript, refuses_what_breaks_a_limit_before_anything_is_written) {
    const auto refused = [this] {
        EXPECT_TRUE(device_.is_busy());
        EXPECT_EQ(device_.poll(now_), Progress::failed);
        return device_.error() == Error::unsupported_config && !bus_.is_busy() && !device_.is_busy();
    };
    device_.begin_configure(Settings{.timing_budget_ms = 30});
    EXPECT_TRUE(refused());
    device_.begin_set_zone({.centre_spad = 0, .width = 4, .height = 4});
    EXPECT_TRUE(refused());
    device_.begin_set_roi_size(3, 8);
    EXPECT_TRUE(refused());
    device_.begin_set_roi_centre(199);
    EXPECT_TRUE(refused()) << "nothing is known of the size yet";
    device_.begin_set_offset(-4097);
    EXPECT_TRUE(refused());
    device_.begin_set_inter_measurement(Microseconds{0});
    EXPECT_TRUE(refused());
    device_.begin_set_range_threshold({.low_mm = 300, .high_mm = 100});
    EXPECT_TRUE(refused());
    load_configuration();
    device_.begin_set_timing_budget(15);
    EXPECT_TRUE(refused()) << "long mode is in force";
    device_.begin_set_distance_mode(DistanceMode::short_range);
    expect_done(R"(
        W 004B 14 | W 0060 07 | W 0063 05 | W 0069 38 | W 0078 07 05 | W 007A 06 06
        W 005E 02 E1 | W 0061 03 88)");
    device_.begin_set_timing_budget(15);
    expect_done("W 005E 00 1D | W 0061 00 27");
    device_.begin_set_distance_mode(DistanceMode::long_range);
    EXPECT_TRUE(refused()) << "15 ms cannot be taken along";
}

TEST_F(DeviceOnScript, a_refused_budget_leaves_the_one_in_force) {
    load_configuration();
    device_.begin_set_timing_budget(25);
    EXPECT_EQ(finish(device_, now_), Progress::failed);
    device_.begin_set_distance_mode(DistanceMode::long_range);
    expect_done(R"(
        W 004B 0A | W 0060 0F | W 0063 0D | W 0069 B8 | W 0078 0F 0D | W 007A 0E 0E
        W 005E 01 CC | W 0061 01 EA)");
}

TEST_F(DeviceOnScript, an_oscillator_that_reads_0_is_an_error) {
    device_.begin_set_inter_measurement(Microseconds{33'000});
    expect_failed(Error::oscillator_zero, "R 00DE 2 -> 04 00 | R 00DE 2 -> 04 00");
    device_.begin_set_inter_measurement(Microseconds{34'567});
    expect_done("R 00DE 2 -> FC 25 | R 00DE 2 -> FC 25 | W 006C 00 00 05 5E");
}

TEST_F(DeviceOnScript, an_oscillator_that_reads_differently_sets_no_period) {
    device_.begin_set_inter_measurement(Microseconds{33'000});
    expect_failed(Error::reads_disagree, "R 00DE 2 -> 00 25 | R 00DE 2 -> 00 A5");
}

TEST_F(DeviceOnScript, trims_polarity_and_threshold_are_written_outright) {
    device_.begin_set_interrupt_polarity(false);
    expect_done("W 0030 01");
    device_.begin_set_range_threshold({.low_mm = 100, .high_mm = 300, .window = RangeWindow::outside});
    expect_done("W 0046 02 | W 0072 01 2C | W 0074 00 64");
}

TEST_F(DeviceOnScript, a_window_replaces_the_one_before_and_every_sample_takes_it_back) {
    device_.begin_set_range_threshold({.low_mm = 100, .high_mm = 300, .window = RangeWindow::above_high});
    expect_done("W 0046 01 | W 0072 01 2C | W 0074 00 64");
    device_.begin_set_range_threshold(
        {.low_mm = 1, .high_mm = 2, .window = RangeWindow::outside, .fires_without_target = true});
    expect_done("W 0046 42 | W 0072 00 02 | W 0074 00 01");
    device_.begin_set_interrupt_on_every_sample();
    expect_done("W 0046 20");
}

TEST_F(DeviceOnScript, zone_costs_one_write_and_carries_the_size_only_if_it_differs) {
    load_configuration();
    device_.begin_set_zone({.centre_spad = 167, .width = 8, .height = 8});
    expect_done("W 007F A7 77");
    device_.begin_set_zone({.centre_spad = 231, .width = 8, .height = 8});
    expect_done("W 007F E7");
    device_.begin_set_zone({.centre_spad = 231, .width = 8, .height = 7});
    expect_done("W 007F E7 67");
    device_.begin_set_roi_centre(199);
    expect_done("W 007F C7");
}

TEST_F(DeviceOnScript, zone_that_failed_is_written_whole_next_time) {
    load_configuration();
    device_.begin_set_zone({.centre_spad = 167, .width = 16, .height = 16});
    EXPECT_EQ(finish(device_, now_), Progress::failed) << "does not fit";
    device_.begin_set_zone({.centre_spad = 199, .width = 16, .height = 16});
    bus_.expect_failure("W 007F C7 | W 007F C7", TransferError::nack_data);
    EXPECT_EQ(finish(device_, now_), Progress::failed);
    device_.begin_set_zone({.centre_spad = 199, .width = 16, .height = 16});
    expect_done("W 007F C7 FF");
}

TEST_F(DeviceOnScript, roi_size_that_failed_half_way_is_not_taken_for_written) {
    load_configuration();
    device_.begin_set_roi_size(8, 8);
    bus_.expect("R 013E 1 -> C7 | W 007F C7");
    bus_.expect_failure("W 0080 77 | W 0080 77", TransferError::nack_data);
    EXPECT_EQ(finish(device_, now_), Progress::failed);
    device_.begin_set_zone({.centre_spad = 199, .width = 16, .height = 16});
    expect_done("W 007F C7 FF");
}

TEST_F(DeviceOnScript, the_default_configuration_brings_back_its_polarity) {
    device_.begin_set_interrupt_polarity(false);
    expect_done("W 0030 01");
    load_configuration();
    device_.begin_read();
    expect_done("R 0031 1 -> 03");
    EXPECT_FALSE(device_.has_measurement()) << "active low again";
}

}  // namespace
}  // namespace octoskin::vl53l1x
