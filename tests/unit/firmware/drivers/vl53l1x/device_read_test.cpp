// Starting, reading, retrying, transfer by transfer, against a script.
#include <gtest/gtest.h>

#include "tests/unit/firmware/drivers/vl53l1x/device_on_script.hpp"

namespace octoskin::vl53l1x {
namespace {

using i2c::TransferError;

// --- start, read, stop

TEST_F(DeviceOnScript, starts_and_stops) {
    device_.begin_start();
    expect_done("W 0086 01 | W 0087 40");
    device_.begin_stop();
    expect_done("W 0087 00");
    device_.begin_start_single();
    expect_done("W 0086 01 | W 0087 10");
    device_.begin_abort();
    expect_done("W 0087 80");
    device_.begin_update_temperature();
    expect_done(R"(
        W 0008 81 | W 000B 92 | W 0086 01 | W 0087 40
        R 0031 1 -> 03 | R 0031 1 -> 02
        W 0086 01 | W 0087 00 | W 0008 09 | W 000B 00)");
}

constexpr const char* kBlock5 = "R 0089 17 -> 09 00 05 1A 00 08 00 00 10 00 10 50 00 04 D2 07 80";
constexpr const char* kBlock6 = "R 0089 17 -> 09 00 06 1A 00 08 00 00 10 00 10 50 00 04 D3 07 80";
constexpr const char* kBlock7 = "R 0089 17 -> 09 00 07 1A 00 08 00 00 10 00 10 50 00 04 D4 07 80";
constexpr const char* kBlock5Flipped = "R 0089 17 -> 09 00 05 1A 00 08 00 00 10 00 10 50 00 04 92 07 80";
constexpr const char* kReadyLow = "R 0031 1 -> 02";
constexpr const char* kIdleHigh = "R 0031 1 -> 03";
constexpr const char* kClear = "W 0086 01";

TEST_F(DeviceOnScript, nothing_ready_is_done_without_a_measurement) {
    device_.begin_read();
    expect_done(kIdleHigh);
    EXPECT_FALSE(device_.has_measurement());
}

TEST_F(DeviceOnScript, ready_is_confirmed_if_so_asked) {
    device_.begin_read(true);
    bus_.expect("R 0031 1 -> 02 | R 0031 1 -> 03");
    expect_done("");
    EXPECT_FALSE(device_.has_measurement()) << "the first answer was wrong";
    EXPECT_EQ(device_.i2c_error_count(), 1);
    device_.begin_read(true);
    bus_.expect("R 0031 1 -> 02 | R 0031 1 -> 02");
    bus_.expect(kBlock5);
    bus_.expect(kBlock5);
    expect_done(kClear);
    EXPECT_TRUE(device_.has_measurement());
    device_.begin_read(true);
    expect_done("R 0031 1 -> 03");
    EXPECT_FALSE(device_.has_measurement()) << "no is enough";
}

// Had the first answer been altered, the data would have become ready after it.
TEST_F(DeviceOnScript, ready_counts_from_the_confirmation_if_that_came_late) {
    for (const std::int64_t later_us : {300, 301}) {
        device_.begin_read(true);
        bus_.expect("R 0031 1 -> 02 | R 0031 1 -> 02");
        bus_.expect(kBlock5);
        bus_.expect(kBlock5);
        EXPECT_EQ(device_.poll(now_), Progress::busy);
        const NodeTime seen = now_ = now_ + Microseconds{100};
        EXPECT_EQ(device_.poll(now_), Progress::busy);
        now_ = now_ + Microseconds{later_us};
        EXPECT_EQ(device_.poll(now_), Progress::busy);
        expect_done(kClear);
        EXPECT_EQ(elapsed(seen, device_.ready_seen()), Microseconds{later_us <= 300 ? 0 : later_us});
    }
}

TEST_F(DeviceOnScript, reads_twice_then_clears) {
    device_.begin_read();
    bus_.expect(kReadyLow);
    bus_.expect(kBlock5);
    bus_.expect(kBlock5);
    expect_done(kClear);
    ASSERT_TRUE(device_.has_measurement());
    EXPECT_EQ(device_.measurement().range_mm, 1234);
    EXPECT_EQ(device_.measurement().stream_count, 5);
}

TEST_F(DeviceOnScript, a_result_that_changes_under_the_reads_is_read_again) {
    device_.begin_read();
    for (const char* transfer : {kReadyLow, kBlock5, kBlock6, kBlock6, kBlock6}) bus_.expect(transfer);
    expect_done(kClear);
    EXPECT_EQ(device_.measurement().range_mm, 1235);
}

TEST_F(DeviceOnScript, but_only_once) {
    device_.begin_read();
    for (const char* transfer : {kReadyLow, kBlock5, kBlock6, kBlock6}) bus_.expect(transfer);
    expect_failed(Error::reads_disagree, kBlock7);
    EXPECT_FALSE(device_.has_measurement());
    EXPECT_EQ(device_.measurement(), Measurement{});
    // The next read has its second try again.
    device_.begin_read();
    for (const char* transfer : {kReadyLow, kBlock5, kBlock6, kBlock6, kBlock6}) bus_.expect(transfer);
    expect_done(kClear);
}

TEST_F(DeviceOnScript, a_flipped_bit_is_told_and_the_last_measurement_stays) {
    device_.begin_read();
    for (const char* transfer : {kReadyLow, kBlock5, kBlock5}) bus_.expect(transfer);
    expect_done(kClear);
    device_.begin_read();
    for (const char* transfer : {kReadyLow, kBlock6}) bus_.expect(transfer);
    expect_failed(Error::reads_disagree, "R 0089 17 -> 09 00 06 1A 00 08 00 00 10 00 10 50 00 04 93 07 80");
    EXPECT_FALSE(device_.has_measurement());
    EXPECT_EQ(device_.measurement().range_mm, 1234);
    device_.begin_read();
    for (const char* transfer : {kReadyLow, kBlock5}) bus_.expect(transfer);
    expect_failed(Error::reads_disagree, kBlock5Flipped);
}

TEST_F(DeviceOnScript, ones_throughout_are_implausible) {
    device_.begin_read();
    constexpr const char* kOnes = "R 0089 17 -> FF FF FF FF FF FF FF FF FF FF FF FF FF FF FF FF FF";
    bus_.expect(kReadyLow);
    bus_.expect(kOnes);
    expect_failed(Error::implausible_block, kOnes);
    EXPECT_FALSE(device_.has_measurement());
}

TEST_F(DeviceOnScript, a_measurement_counts_only_once_it_is_cleared) {
    device_.begin_read();
    for (const char* transfer : {kReadyLow, kBlock5, kBlock5}) bus_.expect(transfer);
    bus_.expect_failure("W 0086 01 | W 0086 01", TransferError::nack_address);
    EXPECT_EQ(finish(device_, now_), Progress::failed);
    EXPECT_FALSE(device_.has_measurement());
    EXPECT_EQ(device_.measurement(), Measurement{});
}

TEST_F(DeviceOnScript, tells_when_it_was_ready_and_when_it_was_not_yet) {
    bus_.expect("W 0086 01 | W 0087 40 | R 0031 1 -> 03 | R 0031 1 -> 02");
    bus_.expect(kBlock5);
    bus_.expect(kBlock5);
    bus_.expect("W 0086 01 | R 0031 1 -> 02");
    bus_.expect(kBlock6);
    bus_.expect(kBlock6);
    bus_.expect(kClear);
    const auto poll_at = [this](std::uint32_t us) { return device_.poll({us}); };
    device_.begin_start();
    EXPECT_EQ(poll_at(1'000), Progress::busy);
    EXPECT_EQ(poll_at(1'095), Progress::busy);
    EXPECT_EQ(poll_at(1'190), Progress::done);
    device_.begin_read();
    EXPECT_EQ(poll_at(20'000), Progress::busy);
    EXPECT_EQ(poll_at(20'120), Progress::done);
    device_.begin_read();
    EXPECT_EQ(poll_at(21'000), Progress::busy);
    EXPECT_EQ(poll_at(21'120), Progress::busy);
    EXPECT_EQ(poll_at(21'600), Progress::busy);
    EXPECT_EQ(poll_at(22'080), Progress::busy);
    EXPECT_EQ(poll_at(22'175), Progress::done);
    EXPECT_EQ(device_.ready_seen(), NodeTime{21'120});
    EXPECT_EQ(device_.not_ready_seen(), NodeTime{20'000}) << "when the poll that found nothing began";
    device_.begin_read();
    for (const std::uint32_t us : {54'000U, 54'120U, 54'600U, 55'080U})
        EXPECT_EQ(poll_at(us), Progress::busy);
    EXPECT_EQ(poll_at(55'175), Progress::done);
    EXPECT_EQ(device_.ready_seen(), NodeTime{54'120});
    EXPECT_EQ(device_.not_ready_seen(), NodeTime{22'080}) << "when the clear began";
}

TEST(DeviceOptions, ready_level_follows_the_polarity) {
    struct Case {
        bool is_active_low;
        const char* idle;
        const char* ready;
    };
    for (const Case& one :
         {Case{true, "R 0031 1 -> 03", "R 0031 1 -> 02"}, Case{false, "R 0031 1 -> 02", "R 0031 1 -> 03"}}) {
        test::ScriptedI2cBus bus{""};
        Device device{bus, Options{.writes_config_in_burst = true, .reads_twice = false}};
        device.begin_set_interrupt_polarity(one.is_active_low);
        bus.expect(one.is_active_low ? "W 0030 11" : "W 0030 01");
        EXPECT_EQ(finish(device), Progress::done);
        device.begin_read();
        bus.expect(one.idle);
        EXPECT_EQ(finish(device), Progress::done);
        EXPECT_FALSE(device.has_measurement());
        device.begin_read();
        bus.expect(one.ready);
        bus.expect(kBlock5);
        bus.expect(kClear);
        EXPECT_EQ(finish(device), Progress::done);
        EXPECT_TRUE(device.has_measurement());
    }
}

TEST(DeviceOptions, polarity_that_is_not_cached_is_read_each_time) {
    test::ScriptedI2cBus bus{""};
    Device device{bus, Options{.reads_twice = false, .caches_polarity = false}};
    for (const char* trace : {"R 0030 1 -> 11 | R 0031 1 -> 03", "R 0030 1 -> 01 | R 0031 1 -> 02"}) {
        device.begin_read();
        bus.expect(trace);
        EXPECT_EQ(finish(device), Progress::done);
        EXPECT_FALSE(device.has_measurement()) << trace;
    }
    for (const char* trace : {"R 0030 1 -> 11 | R 0031 1 -> 02", "R 0030 1 -> 01 | R 0031 1 -> 03"}) {
        device.begin_read();
        bus.expect(trace);
        bus.expect(kBlock5);
        bus.expect(kClear);
        EXPECT_EQ(finish(device), Progress::done);
        EXPECT_TRUE(device.has_measurement()) << trace;
    }
}

TEST(DeviceOptions, without_a_clear_before_the_start_nothing_is_known_of_when_it_was_not_ready) {
    test::ScriptedI2cBus bus{"R 0031 1 -> 03 | W 0087 40 | R 0031 1 -> 02"};
    bus.expect(kBlock5);
    bus.expect(kClear);
    Device device{bus, Options{.reads_twice = false, .clears_before_start = false}};
    device.begin_read();
    EXPECT_EQ(finish(device), Progress::done);
    device.begin_start();
    EXPECT_EQ(finish(device), Progress::done);
    device.begin_read();
    EXPECT_EQ(finish(device), Progress::done);
    EXPECT_EQ(device.not_ready_seen(), std::nullopt);
}

TEST(DeviceOptions, settings_that_read_back_as_none_known_are_a_mismatch) {
    test::ScriptedI2cBus bus{"R 004B 1 -> 0B | R 005E 2 -> 01 DB"};
    Device device{bus, Options::as_st_uld()};
    device.begin_set_timing_budget(33);
    EXPECT_EQ(finish(device), Progress::failed);
    EXPECT_EQ(device.error(), Error::config_mismatch);
    device.begin_set_distance_mode(DistanceMode::long_range);
    EXPECT_EQ(finish(device), Progress::failed);
    EXPECT_EQ(device.error(), Error::config_mismatch) << "0x01DB: the budget of ST's driver before 1.0.2";
}

// --- retries

TEST_F(DeviceOnScript, a_failed_transfer_is_repeated_once) {
    device_.begin_probe(0x29);
    bus_.expect_failure("R 010F 2 -> 00 00", TransferError::nack_address);
    expect_done("R 010F 2 -> EA CC");
    EXPECT_EQ(device_.i2c_error_count(), 1);
}

TEST_F(DeviceOnScript, every_transfer_has_its_own_retry) {
    device_.begin_start();
    bus_.expect_failure("W 0086 01", TransferError::arbitration_lost);
    bus_.expect("W 0086 01");
    bus_.expect_failure("W 0087 40", TransferError::timeout);
    expect_done("W 0087 40");
    EXPECT_EQ(device_.i2c_error_count(), 2);
}

TEST_F(DeviceOnScript, the_second_failure_ends_the_operation_with_its_kind) {
    for (const auto& [kind, expected] : {std::pair{TransferError::nack_address, Error::no_answer},
                                         std::pair{TransferError::nack_data, Error::bus_error},
                                         std::pair{TransferError::timeout, Error::bus_error},
                                         std::pair{TransferError::arbitration_lost, Error::bus_error},
                                         std::pair{TransferError::bus_stuck, Error::bus_error}}) {
        device_.begin_stop();
        bus_.expect_failure("W 0087 00 | W 0087 00", kind);
        EXPECT_EQ(finish(device_, now_), Progress::failed);
        EXPECT_EQ(device_.error(), expected);
        EXPECT_EQ(device_.transfer_error(), kind);
        EXPECT_TRUE(bus_.is_finished());
    }
    EXPECT_EQ(device_.i2c_error_count(), 10);
}

TEST_F(DeviceOnScript, an_operation_after_a_failed_one_starts_afresh) {
    device_.begin_start();
    bus_.expect_failure("W 0086 01 | W 0086 01", TransferError::nack_address);
    EXPECT_EQ(finish(device_, now_), Progress::failed);
    device_.begin_stop();
    bus_.expect_failure("W 0087 00", TransferError::nack_address);
    expect_done("W 0087 00");
}

TEST_F(DeviceOnScript, burst_and_block_get_the_time_of_their_length) {
    load_configuration();
    EXPECT_EQ(bus_.last_time_limit(), Microseconds(1'285)) << "38 bits: 95 us * 3 + 1 ms";
    device_.begin_read();
    bus_.expect(kReadyLow);
    bus_.expect(kBlock5);
    EXPECT_EQ(device_.poll(now_), Progress::busy);
    EXPECT_EQ(device_.poll(now_), Progress::busy);
    EXPECT_EQ(bus_.last_time_limit(), Microseconds(2'440)) << "192 bits";
    bus_.expect(kBlock5);
    expect_done(kClear);
}

TEST_F(DeviceOnScript, reads_registers_for_supervision) {
    device_.begin_read_register(0x007F, 2);
    expect_done("R 007F 2 -> C7 FF");
    ASSERT_EQ(device_.register_bytes().size(), 2U);
    EXPECT_EQ(device_.register_bytes()[0], 0xC7);
    EXPECT_EQ(device_.register_bytes()[1], 0xFF);
    device_.begin_read_register(0x001E, 4);
    bus_.expect_failure("R 001E 4 -> 00 00 00 00 | R 001E 4 -> 00 00 00 00", TransferError::nack_address);
    EXPECT_EQ(finish(device_, now_), Progress::failed);
    EXPECT_EQ(device_.register_bytes().size(), 2U) << "what was read before stays";
}

}  // namespace
}  // namespace octoskin::vl53l1x
