#include "firmware/port/stm32g4/i2c_controller.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "firmware/port/stm32g4/i2c_timing.hpp"
#include "tests/support/stm32g4/address_space.hpp"
#include "tests/support/stm32g4/i2c_model.hpp"

namespace octoskin::stm32g4 {
namespace {

using i2c::TransferError;
using i2c::TransferState;

constexpr std::uint8_t kTarget = 0x52;
constexpr std::uint32_t kTiming = 0x30FA'2C31;
constexpr NodeTime kLater{1'000'000};

class I2cControllerTest : public ::testing::Test {
  protected:
    I2cControllerTest() {
        set_lines(true, true);
        controller_.start(kTiming);
        model_.add_target(kTarget, {0xEA, 0xCC, 0x10});
        space_.time_us() = 0;
    }

    /// PA15 and PB7.
    void set_lines(bool scl, bool sda) {
        space_.word(gpio_a, "IDR") = scl ? 1U << 15U : 0;
        space_.word(gpio_b, "IDR") = sda ? 1U << 7U : 0;
    }
    /// Lets the bus and the interrupt handler run until nothing moves; the handler has to settle each event.
    void run() {
        for (int i = 0; i < 10'000; ++i) {
            for (int calls = 0; model_.is_interrupting(); ++calls) {
                ASSERT_LT(calls, 8) << "an interrupt that does not end";
                controller_.on_interrupt();
            }
            if (!model_.step()) return;
        }
        FAIL() << "the bus never came to rest";
    }
    void submit(std::span<const std::uint8_t> write, std::span<std::uint8_t> read,
                std::uint8_t address = kTarget) {
        controller_.submit({.address = address, .write = write, .read = read}, NodeTime{0}, kLater);
    }

    test::AddressSpace space_;
    test::I2cModel model_{space_, i2c1};
    MicrosecondTimer timer_;
    I2cController controller_{kI2cWirings[0], timer_};
    const std::array<std::uint8_t, 2> index_ = {0x01, 0x0F};
    std::array<std::uint8_t, 3> answer_{};
};

TEST_F(I2cControllerTest, sets_the_timing_while_it_is_off) {
    const std::vector<std::uint32_t> controls = space_.written_to(i2c1.base() + 0x00);
    ASSERT_EQ(controls.size(), 2U);
    EXPECT_EQ(controls[0], 0U);
    EXPECT_EQ(controls[1], 0xF7U);  // PE, TXIE, RXIE, NACKIE, STOPIE, TCIE, ERRIE
    EXPECT_EQ(space_.word(i2c1, "TIMINGR"), kTiming);
    // PA15 and PB7: function 4, open drain.
    EXPECT_EQ(space_.word(gpio_a, "AFRH") >> 28U, 4U);
    EXPECT_EQ(space_.word(gpio_a, "MODER") >> 30U, 2U);
    EXPECT_EQ(space_.word(gpio_a, "OTYPER"), 1U << 15U);
    EXPECT_EQ(space_.word(gpio_b, "AFRL") >> 28U, 4U);
    EXPECT_EQ(space_.word(gpio_b, "OTYPER"), 1U << 7U);
    EXPECT_EQ(space_.word(rcc, "APB1ENR1"), 1U << 21U);
    EXPECT_EQ(space_[0xE000'E100], 1U << 31U);  // interrupt 31
    EXPECT_EQ(space_[0xE000'E104], 1U << 0U);   // interrupt 32
}

TEST_F(I2cControllerTest, writes_an_index_and_reads_the_answer) {
    submit(index_, answer_);
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::pending);
    run();
    EXPECT_EQ(model_.trace(), "S52w 01 0F R52r (EA) (CC) (10) P");
    EXPECT_TRUE(controller_.has_ended());
    EXPECT_EQ(controller_.poll(NodeTime{2}), TransferState::done);
    EXPECT_EQ(controller_.poll(NodeTime{2}), TransferState::idle);
    EXPECT_EQ(answer_, (std::array<std::uint8_t, 3>{0xEA, 0xCC, 0x10}));
}

TEST_F(I2cControllerTest, writes_alone_reads_alone_and_asks_who_is_there) {
    submit(index_, {});
    run();
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::done);
    submit({}, answer_);
    run();
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::done);
    submit({}, {});
    run();
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::done);
    EXPECT_EQ(model_.trace(), "S52w 01 0F P S52r (EA) (CC) (10) P S52w P");
}

TEST_F(I2cControllerTest, moves_every_length_that_the_byte_counter_holds) {
    for (const std::size_t length : {1U, 2U, 3U, 91U, 254U, 255U}) {
        const std::vector<std::uint8_t> out(length, 0x5A);
        std::vector<std::uint8_t> in(length);
        submit(out, in);
        run();
        ASSERT_EQ(controller_.poll(NodeTime{1}), TransferState::done) << length;
        EXPECT_EQ(in[0], 0xEA);
    }
}

TEST_F(I2cControllerTest, puts_the_first_byte_in_before_the_start) {
    space_.forget_writes();
    submit(index_, answer_);
    const auto& writes = space_.writes();
    ASSERT_GE(writes.size(), 2U);
    EXPECT_EQ(writes[0], (test::AddressSpace::Write{i2c1.base() + 0x28, 0x01}));
    EXPECT_EQ(writes[1].address, i2c1.base() + 0x04);
}

TEST_F(I2cControllerTest, tells_a_refused_address_from_every_refused_byte) {
    submit(index_, answer_, 0x29);
    run();
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::failed);
    EXPECT_EQ(controller_.error(), TransferError::nack_address);

    const std::vector<std::uint8_t> bytes(5, 0x11);
    for (std::size_t length = 1; length <= bytes.size(); ++length) {
        for (std::size_t refused = 0; refused < length; ++refused) {
            model_.refuses_byte = refused;
            submit(std::span(bytes).first(length), {});
            run();
            ASSERT_EQ(controller_.poll(NodeTime{1}), TransferState::failed) << length << " " << refused;
            EXPECT_EQ(controller_.error(), TransferError::nack_data) << length << " " << refused;
        }
    }
}

TEST_F(I2cControllerTest, sends_nothing_stale_after_a_refusal) {
    const std::array<std::uint8_t, 3> poison = {0xDE, 0xAD, 0xBE};
    for (int which = 0; which < 4; ++which) {
        model_.refuses_byte.reset();
        if (which > 0) model_.refuses_byte = which - 1;
        submit(poison, {}, which == 0 ? 0x29 : kTarget);
        run();
        ASSERT_EQ(controller_.poll(NodeTime{1}), TransferState::failed);
        model_.refuses_byte.reset();
        model_.clear_trace();
        submit(index_, answer_);
        run();
        EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::done);
        EXPECT_EQ(model_.trace(), "S52w 01 0F R52r (EA) (CC) (10) P") << which;
    }
}

TEST_F(I2cControllerTest, gives_up_at_the_deadline_and_lets_the_lines_go) {
    model_.is_stretched = true;
    controller_.submit({.address = kTarget, .write = index_, .read = {}}, NodeTime{0}, NodeTime{500});
    run();
    EXPECT_EQ(controller_.deadline(), NodeTime{500});
    EXPECT_EQ(controller_.poll(NodeTime{499}), TransferState::pending);
    space_.forget_writes();
    EXPECT_EQ(controller_.poll(NodeTime{500}), TransferState::failed);
    EXPECT_EQ(controller_.error(), TransferError::timeout);
    EXPECT_EQ(space_.written_to(i2c1.base()), (std::vector<std::uint32_t>{0, 0xF7}));
    model_.is_stretched = false;
    submit(index_, answer_);
    run();
    EXPECT_EQ(controller_.poll(NodeTime{501}), TransferState::done);
}

TEST_F(I2cControllerTest, reports_lost_arbitration_and_goes_on) {
    model_.loses_arbitration = true;
    submit(index_, answer_);
    run();
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::failed);
    EXPECT_EQ(controller_.error(), TransferError::arbitration_lost);
    submit(index_, answer_);
    run();
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::done);
}

TEST_F(I2cControllerTest, ignores_a_bus_error_that_is_none) {
    model_.reports_false_bus_error = true;
    submit(index_, answer_);
    run();
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::done);
}

TEST_F(I2cControllerTest, settles_interrupts_that_nobody_waits_for) {
    space_.word(i2c1, "ISR") |= 0x730;  // NACKF, STOPF, BERR, ARLO, OVR
    controller_.on_interrupt();
    EXPECT_FALSE(model_.is_interrupting());
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::idle);
}

/// SDA is held low by a target that lets go after some clocks.
class StuckBusTest : public I2cControllerTest {
  protected:
    StuckBusTest() {
        space_.on_write(gpio_a.base() + 0x18, [this](std::uint32_t&, std::uint32_t value) {
            if ((value >> 31U) != 0) is_scl_high_ = false;
            if (((value >> 15U) & 1U) != 0) {
                if (!is_scl_high_) ++clocks_;
                is_scl_high_ = true;
            }
            update();
        });
        space_.on_write(gpio_b.base() + 0x18, [this](std::uint32_t&, std::uint32_t value) {
            const bool was_high = is_sda_driven_high_;
            if (((value >> 23U) & 1U) != 0) is_sda_driven_high_ = false;
            if (((value >> 7U) & 1U) != 0) is_sda_driven_high_ = true;
            if (is_scl_high_ && !was_high && is_sda_driven_high_ && clocks_ >= lets_go_after_) ++stops_;
            update();
        });
    }
    void hold_sda(int until_clocks) {
        lets_go_after_ = until_clocks;
        update();
    }
    void update() {
        set_lines(is_scl_high_ && !is_scl_held_, is_sda_driven_high_ && clocks_ >= lets_go_after_);
    }

    bool is_scl_high_ = true;
    bool is_scl_held_ = false;
    bool is_sda_driven_high_ = true;
    int clocks_ = 0;
    int lets_go_after_ = 0;
    int stops_ = 0;
};

TEST_F(StuckBusTest, clocks_no_more_than_needed_then_stops) {
    for (int needed = 0; needed <= 9; ++needed) {
        clocks_ = 0;
        stops_ = 0;
        hold_sda(needed);
        const std::uint32_t begun = space_.time_us();
        EXPECT_TRUE(controller_.recover()) << needed;
        EXPECT_EQ(clocks_, needed + 1) << needed;  // and the one of the STOP
        EXPECT_EQ(stops_, 1);
        EXPECT_LE(space_.time_us() - begun, 1'000U);
        EXPECT_EQ(space_.word(gpio_a, "MODER") >> 30U, 2U) << "the pins go back to the controller";
        EXPECT_EQ((space_.word(gpio_b, "MODER") >> 14U) & 3U, 2U);
    }
}

TEST_F(StuckBusTest, gives_up_after_nine_clocks) {
    hold_sda(1000);
    EXPECT_FALSE(controller_.recover());
    EXPECT_EQ(clocks_, 9 + 1);
}

TEST_F(StuckBusTest, tells_a_clock_line_that_stays_low) {
    is_scl_held_ = true;
    update();
    EXPECT_FALSE(controller_.recover());
}

TEST_F(StuckBusTest, frees_the_bus_before_a_transfer) {
    hold_sda(4);
    submit(index_, answer_);
    run();
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::done);
}

TEST_F(StuckBusTest, starts_nothing_on_a_bus_that_stays_held) {
    hold_sda(1000);
    submit(index_, answer_);
    run();
    EXPECT_EQ(model_.trace(), "");
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::failed);
    EXPECT_EQ(controller_.error(), TransferError::bus_stuck);
}

TEST_F(StuckBusTest, drops_a_transfer_in_flight) {
    model_.is_stretched = true;
    submit(index_, answer_);
    EXPECT_TRUE(controller_.recover());
    EXPECT_FALSE(controller_.is_busy());
    EXPECT_EQ(controller_.poll(NodeTime{1}), TransferState::idle);
}

// --- TIMINGR, against the I2C specification by an arithmetic of its own

struct Limits {
    double low_s, high_s, setup_s, rise_s, fall_s;
};
constexpr Limits kStandard{4.7e-6, 4.0e-6, 250e-9, 1000e-9, 300e-9};
constexpr Limits kFast{1.3e-6, 0.6e-6, 100e-9, 300e-9, 300e-9};

TEST(I2cTiming, keeps_the_specification_at_every_filter_delay) {
    for (const I2cTiming& timing : kI2cTimings) {
        SCOPED_TRACE(::testing::Message() << timing.kernel_hz << " " << timing.bus_hz);
        const Limits& limits = timing.bus_hz > 100'000 ? kFast : kStandard;
        const double clock_s = 1.0 / timing.kernel_hz;
        const double tick_s = ((timing.timingr >> 28U) + 1) * clock_s;
        const double low_s = ((timing.timingr & 0xFFU) + 1) * tick_s;
        const double high_s = (((timing.timingr >> 8U) & 0xFFU) + 1) * tick_s;
        const double setup_s = (((timing.timingr >> 20U) & 0xFU) + 1) * tick_s;
        const double sync_min_s = 50e-9 + 2 * clock_s;  // each edge: the filter, then 2 to 3 clocks
        EXPECT_GE(low_s + sync_min_s, limits.low_s);
        EXPECT_GE(high_s + sync_min_s, limits.high_s);
        EXPECT_GE(setup_s, limits.rise_s + limits.setup_s);
        EXPECT_LE(1.0 / (low_s + high_s + 2 * sync_min_s), timing.bus_hz * 1.0001);
        const double sync_max_s = 260e-9 + 3 * clock_s;
        const double slowest_hz = 1.0 / (low_s + high_s + 2 * sync_max_s + limits.rise_s + limits.fall_s);
        EXPECT_GE(slowest_hz, timing.bus_hz * 0.65);
    }
}

TEST(I2cTiming, never_exceeds_what_was_asked) {
    EXPECT_EQ(i2c_timing(160'000'000, 400'000), 0x30FA'2C31U);
    EXPECT_EQ(i2c_timing(160'000'000, 399'999), 0xD0E3'3B34U);
    EXPECT_EQ(i2c_timing(160'000'000, 100'000), 0xD0E3'3B34U);
    EXPECT_FALSE(i2c_timing(160'000'000, 99'999));
    EXPECT_EQ(i2c_timing(16'000'000, 400'000), 0x0061'1011U);
    EXPECT_FALSE(i2c_timing(170'000'000, 400'000));
}

}  // namespace
}  // namespace octoskin::stm32g4
