// Every transfer of every operation refused, once and twice; every bit of a reading flipped; buses and
// sensors that never come to an end.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "tests/support/vl53l1x/sensor_bench.hpp"
#include "tests/unit/firmware/drivers/vl53l1x/operation.hpp"

namespace octoskin::vl53l1x {
namespace {

using sim::I2cFaultKind;

constexpr Settings kSettings{.timing_budget_ms = 33, .inter_measurement_ms = 50, .has_offset = true};

/// An operation with what has to be done before it.
struct Operation {
    std::string name;
    std::function<void(Device&)> begin;
    /// In which state it is begun.
    enum class After : std::uint8_t { boot, first_start, initialised, result } after = After::initialised;
    /// Refused before the configuration is loaded.
    [[nodiscard]] bool builds_on_settings() const { return name == "roi_centre" || name == "distance_mode"; }
};

std::vector<Operation> all_operations() {
    using enum Operation::After;
    return {
        {"probe", [](Device& d) { d.begin_probe(0x29); }, boot},
        {"set_address", [](Device& d) { d.begin_set_address(0x30); }, boot},
        {"await_boot", [](Device& d) { d.begin_await_boot(); }, boot},
        {"load_configuration", [](Device& d) { d.begin_load_configuration(); }, boot},
        {"initialise", [](Device& d) { d.begin_initialise(); }, boot},
        {"finish_initialise", [](Device& d) { d.begin_finish_initialise(); }, first_start},
        {"configure", [](Device& d) { d.begin_configure(kSettings); }},
        {"distance_mode", [](Device& d) { d.begin_set_distance_mode(DistanceMode::short_range); }},
        {"timing_budget", [](Device& d) { d.begin_set_timing_budget(50); }},
        {"inter_measurement", [](Device& d) { d.begin_set_inter_measurement(Microseconds{50'000}); }},
        {"sigma_limit", [](Device& d) { d.begin_set_sigma_limit(60); }},
        {"signal_limit", [](Device& d) { d.begin_set_signal_limit(64); }},
        {"offset", [](Device& d) { d.begin_set_offset(4); }},
        {"crosstalk", [](Device& d) { d.begin_set_crosstalk(1); }},
        {"polarity", [](Device& d) { d.begin_set_interrupt_polarity(true); }},
        {"threshold", [](Device& d) { d.begin_set_range_threshold({.low_mm = 1, .high_mm = 2}); }},
        {"every_sample", [](Device& d) { d.begin_set_interrupt_on_every_sample(); }},
        {"roi_size", [](Device& d) { d.begin_set_roi_size(8, 8); }},
        {"roi_centre", [](Device& d) { d.begin_set_roi_centre(199); }},
        {"zone", [](Device& d) { d.begin_set_zone({.centre_spad = 167, .width = 8, .height = 8}); }},
        {"start", [](Device& d) { d.begin_start(); }},
        {"start_single", [](Device& d) { d.begin_start_single(); }},
        {"stop", [](Device& d) { d.begin_stop(); }},
        {"abort", [](Device& d) { d.begin_abort(); }},
        {"read", [](Device& d) { d.begin_read(); }, result},
        {"read_register", [](Device& d) { d.begin_read_register(0x007F, 2); }},
        {"verify", [](Device& d) { d.begin_verify(7); }},
        {"update_temperature", [](Device& d) { d.begin_update_temperature(); }},
    };
}

/// A fresh sensor and driver, brought to where the operation is begun.
class Case {
  public:
    Case(const Operation& operation, const Options& options) : device_(bench_.bus(), options) {
        using enum Operation::After;
        sensor_ = &bench_.add_booted(test::wall_at(1.0));
        if (operation.after == boot) return;
        device_.begin_load_configuration();
        run();
        if (operation.after == first_start) {
            bench_.wait(Microseconds{100'000});
            return;
        }
        bench_.wait(Microseconds{110'000});
        device_.begin_finish_initialise();
        run();
        if (operation.after == initialised) return;
        device_.begin_start();
        run();
        bench_.wait(Microseconds{250'000});
    }
    void run() { ASSERT_EQ(bench_.finish(device_), Progress::done); }

    test::SensorBench bench_;
    Device device_;
    sim::SensorModel* sensor_ = nullptr;
};

class EveryTransfer : public testing::TestWithParam<bool> {
  protected:
    [[nodiscard]] static Options options() { return GetParam() ? Options::as_st_uld() : Options{}; }
};

std::uint64_t transfers_of(const Operation& operation, const Options& options) {
    Case clean(operation, options);
    const std::uint64_t before = clean.bench_.bus().transfer_count();
    operation.begin(clean.device_);
    clean.run();
    return clean.bench_.bus().transfer_count() - before;
}

struct Refusal {
    I2cFaultKind kind;
    std::uint32_t position;
    Error error;
};
constexpr Refusal kRefusals[] = {
    {I2cFaultKind::nack_address, 0, Error::no_answer}, {I2cFaultKind::nack_read, 0, Error::no_answer},
    {I2cFaultKind::nack_byte, 0, Error::bus_error},    {I2cFaultKind::nack_byte, 1, Error::bus_error},
    {I2cFaultKind::nack_byte, 2, Error::bus_error},    {I2cFaultKind::lose_arbitration, 0, Error::bus_error},
    {I2cFaultKind::stretch, 0, Error::bus_error}};

/// Injects one refusal from transfer `n` of the operation on and runs it.
struct Refused {
    Refused(const Operation& operation, const Options& options, const Refusal& refusal, std::uint64_t n,
            std::uint64_t count)
        : on(operation, options), before(on.bench_.bus().transfer_count()) {
        on.bench_.bus().inject(
            {.kind = refusal.kind, .first = before + n, .count = count, .position = refusal.position});
        operation.begin(on.device_);
        progress = on.bench_.finish(on.device_);
    }
    [[nodiscard]] std::uint64_t transfers() { return on.bench_.bus().transfer_count() - before; }

    Case on;
    std::uint64_t before;
    Progress progress = Progress::idle;
};

TEST_P(EveryTransfer, refused_once_is_repeated_and_refused_twice_ends_the_operation) {
    int refused = 0;
    for (const Operation& operation : all_operations()) {
        const std::uint64_t transfers = transfers_of(operation, options());
        for (std::uint64_t n = 0; n < transfers; ++n) {
            const std::string where = operation.name + ", transfer " + std::to_string(n);
            for (const Refusal& refusal : kRefusals) {
                const Refused once(operation, options(), refusal, n, 1);
                ASSERT_EQ(once.progress, Progress::done) << where;
                // The read of a write and the third byte of a read cannot be refused.
                if (once.on.device_.i2c_error_count() == 0) continue;
                ASSERT_EQ(once.on.device_.i2c_error_count(), 1) << where;

                Refused twice(operation, options(), refusal, n, 2);
                const Device& device = twice.on.device_;
                ASSERT_EQ(twice.progress, Progress::failed) << where;
                ASSERT_EQ(device.i2c_error_count(), 2) << where;
                ASSERT_EQ(device.error(), refusal.error) << where;
                ASSERT_EQ(twice.transfers(), n + 2) << where << ": nothing is sent after it";
                ASSERT_FALSE(device.has_measurement()) << where;
                ASSERT_EQ(device.measurement(), Measurement{}) << where;
                ASSERT_TRUE(device.register_bytes().empty()) << where;
                ++refused;
            }
        }
    }
    EXPECT_GT(refused, 300);
}

// Silence is in order while the part boots; anything else is as in every operation.
TEST_P(EveryTransfer, of_a_soft_reset_may_be_refused_once) {
    const Operation reset{"soft_reset", [](Device& d) { d.begin_soft_reset(); }, Operation::After::boot};
    const std::uint64_t transfers = transfers_of(reset, options());
    ASSERT_GE(transfers, 4U);
    for (std::uint64_t n = 0; n < transfers; ++n) {
        for (const Refusal& refusal : kRefusals) {
            Refused once(reset, options(), refusal, n, 1);
            EXPECT_EQ(once.progress, Progress::done) << n;
            EXPECT_LE(once.on.device_.i2c_error_count(), 1) << n;
            once.on.device_.begin_probe(kDefaultAddress);
            EXPECT_EQ(once.on.bench_.finish(once.on.device_), Progress::done) << n;
            if (refusal.error != Error::bus_error || refusal.kind == I2cFaultKind::nack_byte) continue;
            const Refused twice(reset, options(), refusal, n, 2);
            EXPECT_EQ(twice.progress, Progress::failed) << n;
            EXPECT_EQ(twice.on.device_.error(), Error::bus_error) << n;
        }
    }
}

TEST(Waits, soft_reset_of_a_part_that_never_boots_ends_after_half_a_second) {
    const Operation reset{"soft_reset", [](Device& d) { d.begin_soft_reset(); }, Operation::After::boot};
    Case on(reset, Options{});
    on.sensor_->advance(on.bench_.time());  // this once it did boot
    on.sensor_->set_faults({.never_boots = true});
    const std::int64_t before_us = on.bench_.time().us;
    on.device_.begin_soft_reset();
    EXPECT_EQ(on.bench_.finish(on.device_), Progress::failed);
    EXPECT_EQ(on.device_.error(), Error::boot_timeout);
    EXPECT_LE(on.bench_.time().us - before_us, 505'000);
}

INSTANTIATE_TEST_SUITE_P(Options, EveryTransfer, testing::Bool(),
                         [](const auto& options) { return options.param ? "as_st_uld" : "default"; });

// One bit flipped in one read of a reading: either it is found out, or the measurement is the true one, or it
// is the one before over again, which the stream count shows.
TEST(EveryBit, flipped_in_a_read_never_makes_a_wrong_measurement) {
    const Operation read{"read", [](Device& d) { d.begin_read(); }, Operation::After::result};
    Case clean(read, Options{});
    clean.device_.begin_read();
    clean.run();
    const Measurement truth = clean.device_.measurement();
    constexpr std::uint32_t kReadBits[] = {8, 17 * 8, 17 * 8};
    int found_out = 0;
    for (std::uint64_t transfer = 0; transfer < 3; ++transfer) {
        for (std::uint32_t bit = 0; bit < kReadBits[transfer]; ++bit) {
            Case one(read, Options{});
            one.bench_.bus().inject({.kind = I2cFaultKind::flip_bit,
                                     .first = one.bench_.bus().transfer_count() + transfer,
                                     .position = bit});
            one.device_.begin_read();
            const Progress progress = one.bench_.finish(one.device_);
            if (progress == Progress::done && one.device_.has_measurement()) {
                ASSERT_EQ(one.device_.measurement(), truth) << transfer << ' ' << bit;
            } else {
                ++found_out;
            }
        }
    }
    EXPECT_EQ(found_out, 1 + 2 * (17 - 1) * 8) << "the ready bit, and all but the stream count's";
}

// --- waits

TEST(Counts, failed_transfers_saturate) {
    test::SensorBench bench;
    Device device(bench.bus(), Options{});
    EXPECT_EQ(device.wake_time(), std::nullopt) << "nothing to wait for";
    for (int probe = 1; probe <= 32'770; ++probe) {
        device.begin_probe(0x29);
        ASSERT_EQ(bench.finish(device), Progress::failed);
        ASSERT_EQ(device.i2c_error_count(), std::min(2 * probe, 65'535));
    }
}

TEST(Waits, boot_that_never_completes_ends_after_half_a_second) {
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add(test::wall_at(1.0));
    sensor.set_faults({.status_two_for = Microseconds{60'000'000}});
    bench.set_xshut(sensor, true);
    bench.wait(Microseconds{2'000});
    Device device(bench.bus(), Options{});
    device.begin_initialise();
    const sim::SimTime begin = bench.time();
    EXPECT_EQ(bench.finish(device), Progress::failed);
    EXPECT_EQ(device.error(), Error::boot_timeout);
    EXPECT_NEAR(static_cast<double>(bench.time().us - begin.us), 500'000.0, 2'000.0);
}

TEST(Waits, sensor_that_is_never_ready_ends_after_a_second) {
    for (const bool is_update : {false, true}) {
        test::SensorBench bench(NodeTime{0xFFFF'F000});  // and the node's clock wraps meanwhile
        sim::SensorModel& sensor = bench.add_booted(test::wall_at(1.0));
        sensor.set_faults({.never_ready = true});
        Device device(bench.bus(), Options{});
        device.begin_load_configuration();
        ASSERT_EQ(bench.finish(device), Progress::done);
        const sim::SimTime begin = bench.time();
        is_update ? device.begin_update_temperature() : device.begin_finish_initialise();
        EXPECT_EQ(bench.finish(device), Progress::failed);
        EXPECT_EQ(device.error(), Error::not_ready);
        EXPECT_NEAR(static_cast<double>(bench.time().us - begin.us), 1'003'000.0, 5'000.0);
    }
}

/// Takes a transfer and never ends it, against its contract.
class SilentBus final : public i2c::Bus {
  public:
    bool is_taken = false;
    [[nodiscard]] bool is_busy() const override { return is_taken; }
    void submit(const i2c::Transfer&, NodeTime, NodeTime) override { is_taken = true; }
    [[nodiscard]] i2c::TransferState poll(NodeTime) override {
        return is_taken ? i2c::TransferState::pending : i2c::TransferState::idle;
    }
    [[nodiscard]] i2c::TransferError error() const override { return i2c::TransferError::timeout; }
    bool recover() override {
        is_taken = false;
        return true;
    }
};

TEST(Waits, every_operation_gives_up_a_bus_that_never_answers) {
    for (const Operation& operation : all_operations()) {
        if (operation.builds_on_settings()) continue;
        SilentBus bus;
        Device device(bus, Options{});
        operation.begin(device);
        NodeTime now{};
        EXPECT_EQ(finish(device, now), Progress::failed) << operation.name;
        EXPECT_EQ(device.error(), Error::bus_error) << operation.name;
        EXPECT_LT(now.us, 15'000U) << operation.name;
    }
}

TEST(Waits, every_operation_gives_up_a_bus_that_never_comes_free) {
    for (const Operation& operation : all_operations()) {
        if (operation.builds_on_settings()) continue;
        SilentBus bus;
        bus.is_taken = true;
        Device device(bus, Options{});
        operation.begin(device);
        NodeTime now{};
        EXPECT_EQ(finish(device, now), Progress::failed) << operation.name;
        EXPECT_EQ(device.error(), Error::bus_error) << operation.name;
        EXPECT_NEAR(now.us, 250'000.0, 200.0) << operation.name;
    }
}

/// Somebody else holds the bus when it is told to be; answers with 0 at once.
class SharedBus final : public i2c::Bus {
  public:
    bool is_taken = false;
    [[nodiscard]] bool is_busy() const override { return is_taken || is_in_flight_; }
    void submit(const i2c::Transfer& transfer, NodeTime, NodeTime) override {
        std::ranges::fill(transfer.read, std::uint8_t{0});
        is_in_flight_ = true;
    }
    [[nodiscard]] i2c::TransferState poll(NodeTime) override {
        const bool was_in_flight = std::exchange(is_in_flight_, false);
        return was_in_flight ? i2c::TransferState::done : i2c::TransferState::idle;
    }
    [[nodiscard]] i2c::TransferError error() const override { return i2c::TransferError::timeout; }
    bool recover() override { return true; }

  private:
    bool is_in_flight_ = false;
};

TEST(Waits, each_transfer_waits_for_the_bus_anew) {
    SharedBus bus;
    Device device(bus, Options{});
    device.begin_start();
    bus.is_taken = true;
    EXPECT_EQ(device.poll({0}), Progress::busy);
    EXPECT_EQ(device.poll({249'000}), Progress::busy);
    bus.is_taken = false;
    EXPECT_EQ(device.poll({249'100}), Progress::busy);
    EXPECT_TRUE(bus.is_busy());
    EXPECT_EQ(device.poll({249'200}), Progress::busy) << "the first write is done, the second under way";
    bus.is_taken = true;
    EXPECT_EQ(device.poll({249'300}), Progress::done);

    device.begin_start();
    EXPECT_EQ(device.poll({300'000}), Progress::busy);
    bus.is_taken = false;
    EXPECT_EQ(device.poll({549'000}), Progress::busy);
    bus.is_taken = true;
    EXPECT_EQ(device.poll({549'100}), Progress::busy);
    EXPECT_EQ(device.poll({798'000}), Progress::busy) << "249 ms twice is not 250 ms once";
}

// The pause before the next poll of one operation must not hold up another one half a clock's turn later.
TEST(Waits, a_pause_ends_with_its_operation) {
    SharedBus bus;
    Device device(bus, Options{});
    device.begin_await_boot();
    EXPECT_EQ(device.poll({0}), Progress::busy);
    EXPECT_EQ(device.poll({100}), Progress::busy) << "not booted: a pause until 1,100";
    bus.is_taken = true;
    EXPECT_EQ(device.poll({1'100}), Progress::busy);
    EXPECT_EQ(device.poll({251'100}), Progress::failed);
    bus.is_taken = false;
    constexpr std::uint32_t kHalfTurn = 1U << 31U;
    device.begin_stop();
    EXPECT_EQ(device.poll({kHalfTurn + 1'200}), Progress::busy);
    EXPECT_TRUE(bus.is_busy());
}

TEST(Waits, transfer_dropped_by_a_recovery_counts_as_failed_and_is_repeated) {
    test::SensorBench bench;
    bench.add_booted(test::wall_at(1.0));
    Device device(bench.bus(), Options{});
    device.begin_probe(0x29);
    EXPECT_EQ(device.poll(bench.now()), Progress::busy);
    EXPECT_TRUE(bench.bus().recover());
    EXPECT_EQ(bench.finish(device), Progress::done);
    EXPECT_EQ(device.i2c_error_count(), 1);
}

TEST(Waits, stuck_line_is_told_as_such) {
    test::SensorBench bench;
    sim::SensorModel& sensor = bench.add_booted(test::wall_at(1.0));
    sensor.set_faults({.holds_sda_clocks = 1'000});
    Device device(bench.bus(), Options{});
    device.begin_probe(0x29);
    EXPECT_EQ(bench.finish(device), Progress::failed);
    EXPECT_EQ(device.error(), Error::bus_error);
    EXPECT_EQ(device.transfer_error(), i2c::TransferError::bus_stuck);
}

TEST(Sharing, a_device_leaves_the_others_transfer_alone) {
    test::SensorBench bench;
    bench.add_booted(test::wall_at(1.0));
    Device first(bench.bus(), Options{});
    Device second(bench.bus(), Options{});
    first.begin_probe(0x29);
    second.begin_probe(0x2F);
    EXPECT_EQ(first.poll(bench.now()), Progress::busy);
    EXPECT_EQ(second.poll(bench.now()), Progress::busy);
    EXPECT_EQ(bench.bus().transfer_count(), 0U);
    bench.wait(Microseconds{1'000});
    EXPECT_EQ(second.poll(bench.now()), Progress::busy)
        << "the first one's transfer has ended, not collected";
    EXPECT_EQ(first.poll(bench.now()), Progress::done);
    EXPECT_EQ(second.poll(bench.now()), Progress::busy);
    EXPECT_TRUE(bench.bus().is_busy());
    EXPECT_EQ(bench.finish(second), Progress::failed);
    EXPECT_EQ(second.error(), Error::no_answer);
}

}  // namespace
}  // namespace octoskin::vl53l1x
