// The I2C controller on a wire with a scripted device: every kind of end.
#include <gmock/gmock.h>

#include "tests/board/tiny_board.hpp"

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kNackf = 1U << 4;
constexpr std::uint32_t kStopf = 1U << 5;
constexpr std::uint32_t kArlo = 1U << 9;
constexpr std::uint32_t kNoEnd = 1U << 31;
constexpr std::uint32_t kEnds = kNackf | kStopf | kArlo | kNoEnd;

/// Answers at 0x42, with bytes that count up from `first`.
class Device final : public I2cTarget {
  public:
    explicit Device(std::uint8_t first = 0x10) : first_(first) {}
    bool on_start(std::uint8_t address, bool, SimTime) override { return address == 0x42; }
    bool on_write(std::uint8_t byte, SimTime) override {
        written.push_back(byte);
        return true;
    }
    std::uint8_t on_read(SimTime) override { return static_cast<std::uint8_t>(first_ + read++); }
    void on_stop(SimTime time) override { stopped.push_back(time.us); }

    std::vector<std::uint8_t> written;
    std::vector<std::int64_t> stopped;
    std::uint8_t read = 0;

  private:
    std::uint8_t first_;
};

class I2cTest : public testing::Test {
  protected:
    I2cTest() { tiny_.board().wire(0).attach(device_); }
    void run(const char* function) {
        tiny_.jump(function);
        ASSERT_TRUE(tiny_.run_until_finished()) << tiny_.violations();
    }
    void inject(I2cFaultKind kind, std::uint32_t position = 0) {
        tiny_.board().wire(0).inject({.kind = kind, .first = 0, .count = 1, .position = position});
    }
    [[nodiscard]] std::uint32_t end(std::uint32_t at) const { return tiny_.result(at) & kEnds; }
    /// After the first transfer ended as it may, the second is whole.
    void expect_good_second() {
        EXPECT_EQ(end(4), kStopf);
        EXPECT_EQ(tiny_.result(4) >> 28U, 2U) << "bytes received";
        EXPECT_THAT(std::vector(device_.written.end() - 2, device_.written.end()),
                    testing::ElementsAre(1, 2));
    }

    Device device_;
    TinyBoard tiny_{"i2c_transfers"};
};

TEST_F(I2cTest, write_then_read_takes_as_long_as_its_bits) {
    run("good_then_good");
    EXPECT_EQ(end(0), kStopf);
    EXPECT_EQ(tiny_.result(1), 0x10U);
    EXPECT_EQ(tiny_.result(3), 0x12U);
    EXPECT_THAT(device_.written, testing::ElementsAre(1, 2, 1, 2));
    EXPECT_EQ(tiny_.violations(), "");
    // Address, 2 bytes, address, 3 bytes, START twice and STOP: 7 * 9 + 3 bits; then one byte less. The
    // setting gives 272 to 394 kHz.
    EXPECT_EQ(tiny_.board().wire(0).bit_count(), 66U + 57U);
    const double us = static_cast<double>(tiny_.board().i2c_busy_ps(0)) * 1e-6;
    EXPECT_GT(us, 123 / 0.394);
    EXPECT_LT(us, 123 / 0.272 + 60) << "and the program's own time between the bytes";
}

TEST_F(I2cTest, refused_address_stops_by_itself_and_leaves_the_first_byte_waiting) {
    inject(I2cFaultKind::nack_address);
    run("refused_then_good");
    EXPECT_EQ(end(0), kNackf | kStopf);
    EXPECT_EQ(tiny_.result(0) >> 24U & 0xFU, 0U) << "no byte was asked for";
    EXPECT_EQ(tiny_.result(8), 0U) << "TXE: the preloaded byte is still there";
    expect_good_second();
    EXPECT_EQ(tiny_.violations(), "");
}

TEST_F(I2cTest, refused_index_byte_stops_by_itself) {
    for (const std::uint32_t position : {0U, 1U}) {
        SCOPED_TRACE(position);
        Device device;
        TinyBoard tiny("i2c_transfers");
        tiny.board().wire(0).attach(device);
        tiny.board().wire(0).inject({.kind = I2cFaultKind::nack_byte, .first = 0, .position = position});
        tiny.jump("refused_then_good");
        ASSERT_TRUE(tiny.run_until_finished());
        EXPECT_EQ(tiny.result(0) & kEnds, kNackf | kStopf);
        EXPECT_EQ(tiny.result(4) & kEnds, kStopf);
        EXPECT_THAT(std::vector(device.written.end() - 2, device.written.end()), testing::ElementsAre(1, 2));
    }
}

TEST_F(I2cTest, refused_it_no_longer_asks_for_bytes) {
    inject(I2cFaultKind::nack_byte, 0);
    run("refused_unfed");
    EXPECT_EQ(tiny_.result(0), 0x11U) << "TXE and NACKF without TXIS";
}

TEST_F(I2cTest, refused_read_address_stops_by_itself) {
    inject(I2cFaultKind::nack_read);
    run("refused_then_good");
    EXPECT_EQ(end(0), kNackf | kStopf);
    EXPECT_EQ(tiny_.result(0) >> 28U, 0U);
    expect_good_second();
}

TEST_F(I2cTest, stretched_clock_ends_only_with_the_controllers_reset) {
    inject(I2cFaultKind::stretch);
    run("stretched");
    EXPECT_EQ(end(0), kNoEnd);
    expect_good_second();
}

TEST_F(I2cTest, lost_arbitration_is_told) {
    inject(I2cFaultKind::lose_arbitration);
    run("arbitration");
    EXPECT_EQ(end(0), kArlo);
    expect_good_second();
}

TEST_F(I2cTest, stuck_sda_is_freed_by_as_many_clocks_as_it_takes) {
    inject(I2cFaultKind::sda_stuck_low, 7);
    run("stuck");
    EXPECT_EQ(tiny_.result(0), 1U) << "BUSY";
    EXPECT_EQ(tiny_.result(1), 7U);
    expect_good_second();
    EXPECT_EQ(tiny_.violations(), "");
}

TEST(I2cAbandoned, a_target_in_the_middle_of_a_zero_byte_holds_sda) {
    Device zeros(0x00);  // the second byte is 0x01: seven zeros and a one
    TinyBoard tiny("i2c_transfers");
    tiny.board().wire(0).attach(zeros);
    tiny.jump("abandoned");
    ASSERT_TRUE(tiny.run_until_finished()) << tiny.violations();
    EXPECT_EQ(tiny.result(2), 0U) << "SDA is low after PE=0";
    EXPECT_GE(tiny.result(1), 1U);
    EXPECT_LE(tiny.result(1), 8U);
    EXPECT_EQ(tiny.result(4) & kEnds, kStopf);
}

}  // namespace
}  // namespace octoskin::sim::stm32
