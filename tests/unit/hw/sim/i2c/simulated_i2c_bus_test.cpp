// Durations: the bit counts of the I2C specification (UM10204): 9 clocks a byte, START and STOP counted as
// one each; checked against literal numbers.
#include "hw/sim/i2c/simulated_i2c_bus.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace octoskin::sim {
namespace {

using i2c::TransferError;
using i2c::TransferState;
using Bytes = std::vector<std::uint8_t>;

/// Keeps what it is sent, and answers with one byte over and over.
class RecordingTarget final : public I2cTarget {
  public:
    RecordingTarget(std::uint8_t address, std::uint8_t answer) : address_(address), answer_(answer) {}
    bool on_start(std::uint8_t address, bool, SimTime) override { return address == address_; }
    bool on_write(std::uint8_t byte, SimTime time) override {
        written.push_back(byte);
        written_at.push_back(time.us);
        return true;
    }
    std::uint8_t on_read(SimTime time) override {
        read_at.push_back(time.us);
        return answer_;
    }
    void on_stop(SimTime) override { ++stops; }
    bool holds_sda(SimTime) override { return held_clocks > 0; }
    void on_clocks(std::uint32_t count, SimTime) override { held_clocks -= std::min(held_clocks, count); }

    Bytes written;
    std::vector<std::int64_t> written_at;
    std::vector<std::int64_t> read_at;
    int stops = 0;
    std::uint32_t held_clocks = 0;

  private:
    std::uint8_t address_;
    std::uint8_t answer_;
};

class SimulatedBus : public testing::Test {
  protected:
    struct Outcome {
        TransferState state = TransferState::idle;
        std::int64_t duration_us = 0;
        Bytes read;
    };
    Outcome run(SimulatedI2cBus& bus, std::uint8_t address, const Bytes& write, std::size_t read_bytes) {
        Bytes read(read_bytes, 0x00);
        const SimTime begin = present_.time;
        bus.submit({address, write, read}, now(), now() + kDeadline);
        const auto end = bus.transfer_end();
        present_.time = end ? *end : SimTime{begin.us + kDeadline.count()};
        const TransferState state = bus.poll(now());
        return {state, present_.time.us - begin.us, read};
    }
    Outcome run(const Bytes& write, std::size_t read_bytes) { return run(bus_, 0x29, write, read_bytes); }
    [[nodiscard]] NodeTime now() const { return {static_cast<std::uint32_t>(present_.time.us)}; }

    static constexpr Microseconds kDeadline{50'000};
    Present present_;
    SimulatedI2cBus bus_{present_, 400'000};
    RecordingTarget target_{0x29, 0xA5};

    void SetUp() override { bus_.attach(target_); }
};

TEST_F(SimulatedBus, transfers_last_as_long_as_their_bits) {
    struct Case {
        std::size_t written;  // index included
        std::size_t read;
        std::int64_t us_100k;
        std::int64_t us_400k;
        std::int64_t us_1m;
    };
    // 48, 57, 192, 38, 47, 65 and 848 bits.
    const Case cases[] = {{2, 1, 480, 120, 48},    {2, 2, 570, 143, 57}, {2, 17, 1920, 480, 192},
                          {3, 0, 380, 95, 38},     {4, 0, 470, 118, 47}, {6, 0, 650, 163, 65},
                          {93, 0, 8480, 2120, 848}};
    for (const Case& one : cases) {
        for (const auto& [hz, expected_us] :
             {std::pair{100'000U, one.us_100k}, std::pair{400'000U, one.us_400k},
              std::pair{1'000'000U, one.us_1m}}) {
            SimulatedI2cBus bus(present_, hz);
            bus.attach(target_);
            const Outcome outcome = run(bus, 0x29, Bytes(one.written, 0), one.read);
            EXPECT_EQ(outcome.state, TransferState::done);
            EXPECT_EQ(outcome.duration_us, expected_us) << one.written << " written, " << one.read << " read";
        }
    }
}

TEST_F(SimulatedBus, is_pending_until_the_last_bit_and_tells_its_end_once) {
    Bytes read(1);
    const Bytes write{0x00, 0x31};
    bus_.submit({0x29, write, read}, now(), now() + kDeadline);
    EXPECT_TRUE(bus_.is_busy());
    present_.time = {119};
    EXPECT_EQ(bus_.poll(now()), TransferState::pending);
    EXPECT_EQ(read[0], 0x00) << "nothing is there before the end";
    present_.time = {120};
    EXPECT_EQ(bus_.poll(now()), TransferState::done);
    EXPECT_EQ(read[0], 0xA5);
    EXPECT_FALSE(bus_.is_busy());
    EXPECT_EQ(bus_.poll(now()), TransferState::idle);
}

TEST_F(SimulatedBus, every_byte_passes_at_its_own_time) {
    present_.time = {1'000};
    EXPECT_EQ(run({0x00, 0x89}, 2).state, TransferState::done);
    // START and address 10 bits, then 9 a byte; repeated START and address 10 more. 2.5 us a bit, rounded up.
    EXPECT_EQ(target_.written_at, (std::vector<std::int64_t>{1'048, 1'070}));
    EXPECT_EQ(target_.read_at, (std::vector<std::int64_t>{1'118, 1'140}));
    EXPECT_EQ(target_.stops, 1);
}

TEST_F(SimulatedBus, reads_without_an_index_phase) {
    const Outcome outcome = run({}, 3);
    EXPECT_EQ(outcome.state, TransferState::done);
    EXPECT_EQ(outcome.read, (Bytes{0xA5, 0xA5, 0xA5}));
    EXPECT_EQ(outcome.duration_us, 95) << "1 + 9 + 27 + 1 bits";
}

TEST_F(SimulatedBus, nobody_at_the_address_ends_after_eleven_bits) {
    const Outcome outcome = run(bus_, 0x2A, {0x01, 0x0F}, 2);
    EXPECT_EQ(outcome.state, TransferState::failed);
    EXPECT_EQ(bus_.error(), TransferError::nack_address);
    EXPECT_EQ(outcome.duration_us, 28);
}

TEST_F(SimulatedBus, two_devices_at_one_address_are_a_wired_and) {
    RecordingTarget other(0x29, 0x3C);
    bus_.attach(other);
    EXPECT_EQ(run({0x00, 0x31}, 1).read, Bytes{0xA5 & 0x3C});
    EXPECT_EQ(run({0x00, 0x87, 0x40}, 0).state, TransferState::done);
    EXPECT_EQ(target_.written, other.written);
}

TEST_F(SimulatedBus, accounts_for_bits_and_time) {
    EXPECT_EQ(run({0x00, 0x89}, 17).state, TransferState::done);
    EXPECT_EQ(run({0x00, 0x86, 0x01}, 0).state, TransferState::done);
    EXPECT_EQ(bus_.transfer_count(), 2U);
    EXPECT_EQ(bus_.bit_count(), 230U);
    EXPECT_EQ(bus_.busy_time(), Microseconds(575));
}

TEST_F(SimulatedBus, a_byte_is_refused_where_the_fault_says) {
    for (std::uint32_t position = 0; position < 3; ++position) {
        bus_.inject({.kind = I2cFaultKind::nack_byte, .first = bus_.transfer_count(), .position = position});
        target_.written.clear();
        const Outcome outcome = run({0x00, 0x87, 0x40}, 0);
        EXPECT_EQ(outcome.state, TransferState::failed);
        EXPECT_EQ(bus_.error(), TransferError::nack_data);
        EXPECT_EQ(target_.written.size(), position) << "the refused byte does not arrive";
    }
    EXPECT_EQ(run({0x00, 0x87, 0x40}, 0).state, TransferState::done) << "and only there";
}

TEST_F(SimulatedBus, a_refused_repeated_start_is_an_address_error) {
    bus_.inject({.kind = I2cFaultKind::nack_read});
    EXPECT_EQ(run({0x00, 0x31}, 1).state, TransferState::failed);
    EXPECT_EQ(bus_.error(), TransferError::nack_address);
}

TEST_F(SimulatedBus, faults_hit_the_transfers_they_name) {
    bus_.inject({.kind = I2cFaultKind::nack_address, .first = 1, .count = 2});
    std::vector<TransferState> states;
    for (int i = 0; i < 4; ++i) states.push_back(run({0x00, 0x31}, 1).state);
    using enum TransferState;
    EXPECT_EQ(states, (std::vector{done, failed, failed, done}));
}

TEST_F(SimulatedBus, faults_can_be_one_addresss_only) {
    RecordingTarget other(0x30, 0x00);
    bus_.attach(other);
    bus_.inject({.kind = I2cFaultKind::nack_address, .count = 100, .address = 0x30});
    EXPECT_EQ(run(bus_, 0x29, {0x00, 0x31}, 1).state, TransferState::done);
    EXPECT_EQ(run(bus_, 0x30, {0x00, 0x31}, 1).state, TransferState::failed);
}

TEST_F(SimulatedBus, each_bit_read_can_be_flipped) {
    for (std::uint32_t bit = 0; bit < 16; ++bit) {
        bus_.inject({.kind = I2cFaultKind::flip_bit, .first = bus_.transfer_count(), .position = bit});
        const Bytes read = run({0x00, 0x89}, 2).read;
        const unsigned word = (unsigned{read[0]} << 8U) | read[1];
        EXPECT_EQ(word ^ 0xA5A5U, 0x8000U >> bit);
    }
}

TEST_F(SimulatedBus, each_bit_written_can_be_flipped) {
    for (std::uint32_t bit = 0; bit < 24; ++bit) {
        bus_.inject(
            {.kind = I2cFaultKind::flip_written_bit, .first = bus_.transfer_count(), .position = bit});
        target_.written.clear();
        EXPECT_EQ(run({0x00, 0x87, 0x40}, 0).state, TransferState::done);
        const unsigned arrived =
            (unsigned{target_.written[0]} << 16U) | (unsigned{target_.written[1]} << 8U) | target_.written[2];
        EXPECT_EQ(arrived ^ 0x008740U, 0x800000U >> bit);
    }
}

TEST_F(SimulatedBus, a_lost_write_is_acknowledged_but_does_not_arrive) {
    bus_.inject({.kind = I2cFaultKind::lose_write});
    EXPECT_EQ(run({0x00, 0x87, 0x40}, 0).state, TransferState::done);
    EXPECT_EQ(target_.written, (Bytes{0x00, 0x87}));
}

TEST_F(SimulatedBus, a_device_that_lets_go_leaves_ones) {
    bus_.inject({.kind = I2cFaultKind::read_ones, .position = 2});
    EXPECT_EQ(run({0x00, 0x89}, 4).read, (Bytes{0xA5, 0xA5, 0xFF, 0xFF}));
}

TEST_F(SimulatedBus, lost_arbitration_is_told) {
    bus_.inject({.kind = I2cFaultKind::lose_arbitration});
    EXPECT_EQ(run({0x00, 0x31}, 1).state, TransferState::failed);
    EXPECT_EQ(bus_.error(), TransferError::arbitration_lost);
}

TEST_F(SimulatedBus, a_stretched_clock_ends_at_the_deadline) {
    bus_.inject({.kind = I2cFaultKind::stretch});
    Bytes read(1);
    const Bytes write{0x00, 0x31};
    bus_.submit({0x29, write, read}, now(), now() + Microseconds(1'360));
    EXPECT_FALSE(bus_.transfer_end());
    present_.time = {1'359};
    EXPECT_EQ(bus_.poll(now()), TransferState::pending);
    present_.time = {1'360};
    EXPECT_EQ(bus_.poll(now()), TransferState::failed);
    EXPECT_EQ(bus_.error(), TransferError::timeout);
    EXPECT_EQ(run({0x00, 0x31}, 1).state, TransferState::done) << "the bus was reset";
}

TEST_F(SimulatedBus, nine_clocks_free_a_line_that_needs_no_more) {
    bus_.inject({.kind = I2cFaultKind::sda_stuck_low, .position = 9});
    const Outcome outcome = run({0x00, 0x31}, 1);
    EXPECT_EQ(outcome.state, TransferState::done);
    EXPECT_EQ(outcome.duration_us, 145) << "9 clocks and a STOP come first: 58 bits";
}

TEST_F(SimulatedBus, a_stuck_line_stays_stuck_until_it_got_its_clocks) {
    bus_.inject({.kind = I2cFaultKind::sda_stuck_low, .position = 28});
    EXPECT_EQ(run({0x00, 0x31}, 1).state, TransferState::failed);
    EXPECT_EQ(bus_.error(), TransferError::bus_stuck);
    EXPECT_FALSE(bus_.recover()) << "18 of 28";
    EXPECT_EQ(run({0x00, 0x31}, 1).state, TransferState::failed) << "27 of 28";
    EXPECT_TRUE(bus_.recover());
    EXPECT_EQ(run({0x00, 0x31}, 1).state, TransferState::done);
}

TEST_F(SimulatedBus, a_device_that_holds_the_line_blocks_everybody_until_it_lets_go) {
    target_.held_clocks = 100;
    RecordingTarget other(0x30, 0x00);
    bus_.attach(other);
    EXPECT_EQ(run(bus_, 0x30, {0x00, 0x31}, 1).state, TransferState::failed);
    EXPECT_EQ(bus_.error(), TransferError::bus_stuck);
    target_.held_clocks = 0;
    EXPECT_EQ(run(bus_, 0x30, {0x00, 0x31}, 1).state, TransferState::done);
}

TEST_F(SimulatedBus, recovering_drops_the_transfer_in_flight) {
    bus_.inject({.kind = I2cFaultKind::stretch});
    Bytes read(1);
    const Bytes write{0x00, 0x31};
    bus_.submit({0x29, write, read}, now(), now() + kDeadline);
    EXPECT_TRUE(bus_.recover());
    EXPECT_FALSE(bus_.is_busy());
    EXPECT_EQ(bus_.poll(now()), TransferState::idle);
    EXPECT_EQ(bus_.transfer_count(), 1U) << "it counts all the same";
    EXPECT_EQ(run({0x00, 0x31}, 1).state, TransferState::done);
}

}  // namespace
}  // namespace octoskin::sim
