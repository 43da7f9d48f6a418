// The port's small parts: XSHUT lines, serial port, light, watchdog, reset cause, fault record, pins.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#include "firmware/port/stm32g4/fault_record.hpp"
#include "firmware/port/stm32g4/pin.hpp"
#include "firmware/port/stm32g4/reset_cause.hpp"
#include "firmware/port/stm32g4/serial_port.hpp"
#include "firmware/port/stm32g4/status_light.hpp"
#include "firmware/port/stm32g4/text_line.hpp"
#include "firmware/port/stm32g4/unique_id.hpp"
#include "firmware/port/stm32g4/watchdog.hpp"
#include "firmware/port/stm32g4/xshut_chain.hpp"
#include "firmware/port/stm32g4/xshut_lines.hpp"
#include "tests/support/stm32g4/address_space.hpp"

namespace octoskin::stm32g4 {
namespace {

constexpr Address kSetResetA = 0x4800'0018;
constexpr Address kSetResetC = 0x4800'0818;

// --- five 74HC595 behind PC0..PC3

class XshutChainTest : public ::testing::Test {
  protected:
    XshutChainTest() {
        shown_.fill(true);  // what they hold at power-on is anything
        shifted_.fill(true);
        space_.on_write(kSetResetC, [this](std::uint32_t&, std::uint32_t value) { on_pins(value); });
    }
    void on_pins(std::uint32_t value) {
        const std::array<bool, 4> before = pins_;
        for (unsigned pin = 0; pin < pins_.size(); ++pin) {
            if (((value >> (16 + pin)) & 1U) != 0) pins_[pin] = false;
            if (((value >> pin) & 1U) != 0) pins_[pin] = true;
        }
        if (!before[1] && pins_[1]) {  // a rising edge of SRCLK
            for (std::size_t i = shifted_.size() - 1; i > 0; --i) shifted_[i] = shifted_[i - 1];
            shifted_[0] = pins_[0];
        }
        if (!before[2] && pins_[2]) shown_ = shifted_;
        const bool is_on = !pins_[3];
        for (std::size_t i = 0; i < shown_.size(); ++i) ever_high_[i] |= is_on && shown_[i];
    }
    [[nodiscard]] bool is_high(std::size_t line) const { return !pins_[3] && shown_[line]; }

    test::AddressSpace space_;
    XshutChain chain_;
    std::array<bool, 4> pins_ = {false, false, false, true};  // OE has a pull-up
    std::array<bool, 40> shifted_{};
    std::array<bool, 40> shown_{};
    std::array<bool, 40> ever_high_{};
};

TEST_F(XshutChainTest, raises_no_line_while_it_starts) {
    chain_.start();
    for (std::size_t line = 0; line < 40; ++line) EXPECT_FALSE(ever_high_[line]) << line;
    EXPECT_FALSE(pins_[3]) << "outputs are on";
}

TEST_F(XshutChainTest, sets_each_line_and_only_that_one) {
    chain_.start();
    for (std::uint8_t line = 0; line < 40; ++line) {
        chain_.set(line, true);
        for (std::size_t other = 0; other < 40; ++other) EXPECT_EQ(is_high(other), other == line);
        chain_.set(line, false);
    }
}

TEST_F(XshutChainTest, keeps_the_others_as_they_are) {
    chain_.start();
    for (std::uint8_t line = 0; line < 40; line += 3) chain_.set(line, true);
    chain_.set(9, false);
    for (std::size_t line = 0; line < 40; ++line)
        EXPECT_EQ(is_high(line), line % 3 == 0 && line != 9) << line;
}

TEST_F(XshutChainTest, costs_nothing_where_nothing_changes) {
    chain_.start();
    chain_.set(4, true);
    space_.forget_writes();
    chain_.set(3, false);
    chain_.set(4, true);
    EXPECT_TRUE(space_.writes().empty());
}

// --- eight XSHUT lines that are pins, each with a pull-up outside

struct XshutPin {
    Address port;
    std::uint32_t number;
};
constexpr Address kPortA = 0x4800'0000;
constexpr Address kPortB = 0x4800'0400;
constexpr std::array<XshutPin, 8> kXshutPins = {{{kPortA, 0},
                                                 {kPortA, 1},
                                                 {kPortA, 4},
                                                 {kPortB, 0},
                                                 {kPortA, 6},
                                                 {kPortA, 7},
                                                 {kPortB, 10},
                                                 {kPortB, 5}}};

class XshutLinesTest : public ::testing::Test {
  protected:
    XshutLinesTest() {
        for (const Address port : {kPortA, kPortB}) {
            space_[port + kModer] = 0xFFFF'FFFF;
            space_[port + kOdr] = 0xFFFF;  // what a run before left
            space_.on_write(port + kSetReset, [this, port](std::uint32_t&, std::uint32_t value) {
                space_[port + kOdr] = (space_[port + kOdr] & ~(value >> 16U)) | (value & 0xFFFFU);
                look_for_driven_high();
            });
            for (const Address offset : {kModer, kOtyper}) {
                space_.on_write(port + offset, [this](std::uint32_t& word, std::uint32_t value) {
                    word = value;
                    look_for_driven_high();
                });
            }
        }
    }
    [[nodiscard]] bool is_output(const XshutPin& pin) {
        return (space_[pin.port + kModer] >> (2 * pin.number) & 3U) == 1;
    }
    [[nodiscard]] bool is_low(const XshutPin& pin) {
        return is_output(pin) && (space_[pin.port + kOdr] >> pin.number & 1U) == 0;
    }
    void look_for_driven_high() {
        for (const XshutPin& pin : kXshutPins) {
            const bool is_open_drain = (space_[pin.port + kOtyper] >> pin.number & 1U) != 0;
            was_driven_high_ |= is_output(pin) && !is_low(pin) && !is_open_drain;
        }
    }
    void expect_low_but(std::size_t released) {
        for (std::size_t i = 0; i < kXshutPins.size(); ++i)
            EXPECT_EQ(is_low(kXshutPins.at(i)), i != released) << i;
    }

    static constexpr Address kModer = 0x00;
    static constexpr Address kOtyper = 0x04;
    static constexpr Address kOdr = 0x14;
    static constexpr Address kSetReset = 0x18;
    static constexpr std::size_t kNone = 8;
    test::AddressSpace space_;
    XshutLines lines_;
    bool was_driven_high_ = false;
};

TEST_F(XshutLinesTest, pins_are_low_from_the_start_on) {
    lines_.start();
    expect_low_but(kNone);
    EXPECT_FALSE(was_driven_high_);
}

TEST_F(XshutLinesTest, releases_each_pin_and_only_that_one) {
    lines_.start();
    space_.forget_writes();
    for (std::uint8_t i = 0; i < 8; ++i) {
        lines_.set(static_cast<std::uint8_t>(40 + i), true);
        expect_low_but(i);
        lines_.set(static_cast<std::uint8_t>(40 + i), false);
        expect_low_but(kNone);
    }
    EXPECT_FALSE(was_driven_high_);
    EXPECT_TRUE(space_.written_to(kSetResetC).empty()) << "nothing is shifted";
}

TEST_F(XshutLinesTest, the_first_forty_are_the_chain) {
    lines_.start();
    space_.forget_writes();
    lines_.set(39, true);
    EXPECT_FALSE(space_.written_to(kSetResetC).empty());
    expect_low_but(kNone);
}

// --- serial port

class SerialPortTest : public ::testing::Test {
  protected:
    static constexpr Address kControl = 0x4000'8000;
    static constexpr Address kStatus = 0x4000'801C;

    SerialPortTest() {
        space_.on_write(0x4000'8028,
                        [this](std::uint32_t&, std::uint32_t value) { heard_ += static_cast<char>(value); });
        space_[kStatus] = 1U << 7U;
        serial_.start(160'000'000);
    }
    void run() {
        for (int i = 0; i < 10'000 && (space_[kControl] & (1U << 7U)) != 0; ++i) serial_.on_interrupt();
    }

    test::AddressSpace space_;
    SerialPort serial_;
    std::string heard_;
};

TEST_F(SerialPortTest, says_lines_whole_and_then_rests) {
    EXPECT_EQ(space_[0x4000'800C], 0x56CE4U);
    EXPECT_TRUE(serial_.say("node 3"));
    EXPECT_TRUE(serial_.say("ranging"));
    EXPECT_FALSE(serial_.is_quiet());
    run();
    EXPECT_TRUE(serial_.is_quiet());
    EXPECT_EQ(heard_, "node 3\r\nranging\r\n");
    EXPECT_EQ(space_[kControl] & (1U << 7U), 0U);
}

TEST_F(SerialPortTest, waits_for_room_in_the_hardware) {
    space_[kStatus] = 0;
    EXPECT_TRUE(serial_.say("x"));
    serial_.on_interrupt();
    EXPECT_EQ(heard_, "");
}

TEST_F(SerialPortTest, loses_whole_lines_never_parts) {
    const std::string line(98, 'x');
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(serial_.say(line));
    EXPECT_FALSE(serial_.say(line));
    EXPECT_TRUE(serial_.say("0123456789"));
    EXPECT_FALSE(serial_.say(""));
    EXPECT_EQ(serial_.lost_count(), 2U);
    run();
    EXPECT_EQ(heard_.size(), 512U);
    EXPECT_EQ(heard_.substr(500), "0123456789\r\n");
}

TEST(TextLine, composes_numbers_without_printf) {
    const auto decimal = [](std::uint32_t value) { return std::string(TextLine().number(value).view()); };
    for (const std::uint32_t value : {0U, 9U, 10U, 99U, 100U, 4'294'967'295U}) {
        EXPECT_EQ(decimal(value), std::to_string(value));
    }
    EXPECT_EQ(TextLine().text("at ").hex(0x0800'1ABC, 8).hex(0xF, 1).hex(0xF, 2).view(), "at 08001ABCF0F");
    TextLine full;
    for (int i = 0; i < 30; ++i) full.text("0123456789");
    EXPECT_EQ(full.view().size(), 100U);
}

// --- light

class StatusLightTest : public ::testing::Test {
  protected:
    StatusLightTest() {
        space_.on_write(kSetResetA, [this](std::uint32_t&, std::uint32_t value) {
            const bool was_lit = is_lit_;
            if (((value >> 5U) & 1U) != 0) is_lit_ = true;
            if (((value >> 21U) & 1U) != 0) is_lit_ = false;
            if (!was_lit && is_lit_) ++flashes_;
        });
        light_.start();
    }
    /// For 2^21 us, from `now`: one period of the flashes, half of it dark however many there are.
    NodeTime watch_a_period(NodeTime now) {
        flashes_ = 0;
        const NodeTime end = now + Microseconds{1 << 21};
        while (!is_reached(end, now)) now = light_.poll(now);
        return now;
    }

    test::AddressSpace space_;
    StatusLight light_;
    bool is_lit_ = false;
    int flashes_ = 0;
};

TEST_F(StatusLightTest, flashes_as_often_as_it_has_to_say) {
    NodeTime now{0xFFE0'0000};  // over the clock's wrap
    for (const Flashes flashes : {Flashes::all_is_well, Flashes::no_crystal, Flashes::bad_config,
                                  Flashes::can_fault, Flashes::no_ranges}) {
        light_.show(flashes);
        now = watch_a_period(now);
        EXPECT_EQ(flashes_, static_cast<int>(flashes));
        // The longest pause tells where to begin to count.
        for (std::uint32_t slot = 9; slot < 16; ++slot) {
            (void)light_.poll(now + Microseconds{slot << 17U});
            EXPECT_FALSE(is_lit_) << slot;
        }
        now = now + Microseconds{1 << 21};
    }
}

TEST_F(StatusLightTest, obeys_the_node_while_that_blinks) {
    light_.show(Flashes::no_crystal);
    light_.set(true);
    NodeTime now{50'000};
    (void)light_.poll(now);
    EXPECT_TRUE(is_lit_);
    EXPECT_EQ(light_.poll(NodeTime{400'000}), NodeTime{1'050'000});
    EXPECT_TRUE(is_lit_) << "400 ms lies in a pause between flashes";
    (void)light_.poll(NodeTime{1'200'000});
    EXPECT_FALSE(is_lit_) << "a pause between flashes again";
    watch_a_period(NodeTime{1U << 21U});
    EXPECT_EQ(flashes_, 2);
}

// --- watchdog

TEST(Watchdog, bites_within_200_ms_of_the_slowest_oscillator) {
    test::AddressSpace space;
    IndependentWatchdog watchdog;
    watchdog.start();
    EXPECT_EQ(space.written_to(0x4000'3000), (std::vector<std::uint32_t>{0xCCCC, 0x5555, 0xAAAA}));
    const std::uint32_t divider = 4U << space[0x4000'3004];
    const std::uint32_t counts = space[0x4000'3008] + 1;
    EXPECT_LE(1000.0 * divider * counts / 24'000, 200.0);
    EXPECT_GE(1000.0 * divider * counts / 40'000, 100.0) << "five feeds of the node core fit in";
    watchdog.feed();
    EXPECT_EQ(space.written_to(0x4000'3000).back(), 0xAAAAU);
}

// RM0440: a feed before PVU and RVU are 0 loads the old period.
TEST(Watchdog, feeds_first_when_the_slow_clock_has_taken_the_period_over) {
    test::AddressSpace space;
    std::uint32_t looks = 0;
    space.before_read(0x4000'300C, [&looks](std::uint32_t& status) {
        ++looks;
        status = looks < 20 ? 3U : looks < 30 ? 2U : looks < 40 ? 1U : 0U;
    });
    std::uint32_t looks_at_feed = 0;
    space.on_write(0x4000'3000, [&](std::uint32_t&, std::uint32_t key) {
        if (key == 0xAAAA) looks_at_feed = looks;
    });
    IndependentWatchdog watchdog;
    watchdog.start();
    EXPECT_EQ(looks_at_feed, 40U);
}

TEST(Watchdog, does_not_wait_for_ever_for_it) {
    test::AddressSpace space;
    space.before_read(0x4000'300C, [](std::uint32_t& status) { status = 3; });
    IndependentWatchdog watchdog;
    watchdog.start();
    EXPECT_EQ(space.written_to(0x4000'3000).back(), 0xAAAAU);
}

// --- reset cause

TEST(ResetCause, is_found_for_every_combination_of_flags) {
    using wire::ResetCause;
    for (std::uint32_t flags = 0; flags < 128; ++flags) {
        for (const bool is_ram_kept : {false, true}) {
            const bool option = (flags & 1U) != 0, pin = (flags & 2U) != 0, brown = (flags & 4U) != 0;
            const bool software = (flags & 8U) != 0, dog = (flags & 0x30U) != 0, power = (flags & 0x40U) != 0;
            ResetCause expected = ResetCause::unknown;
            if (brown) {
                expected = is_ram_kept ? ResetCause::brown_out : ResetCause::power_on;
            } else if (dog) {
                expected = ResetCause::watchdog;
            } else if (software || option) {
                expected = ResetCause::software;
            } else if (!power && pin) {
                expected = ResetCause::pin;
            }
            EXPECT_EQ(reset_cause(flags << 25U, is_ram_kept), expected) << flags;
        }
    }
}

TEST(ResetCause, is_taken_once) {
    test::AddressSpace space;
    space[0x4002'1094] = 0x2400'0003;
    EXPECT_EQ(take_reset_flags(), 0x2400'0003U);
    const auto writes = space.written_to(0x4002'1094);
    ASSERT_EQ(writes.size(), 2U);
    EXPECT_EQ(writes[0] & (1U << 23U), 1U << 23U) << "RMVF set";
    EXPECT_EQ(writes[1] & (1U << 23U), 0U) << "and released, so that the next reset shows";
    EXPECT_EQ(writes[1] & 3U, 3U) << "the slow oscillator stays as it is";
}

// --- fault record

TEST(FaultRecord, tells_its_own_from_whatever_memory_holds) {
    for (const int fill : {0x00, 0xFF, 0xA5}) {
        alignas(FaultRecord) std::array<unsigned char, sizeof(FaultRecord)> memory{};
        std::memset(memory.data(), fill, memory.size());
        EXPECT_FALSE(std::launder(reinterpret_cast<FaultRecord*>(memory.data()))->read()) << fill;
    }
}

TEST(FaultRecord, keeps_a_fault_and_notices_every_flipped_bit) {
    alignas(FaultRecord) std::array<unsigned char, sizeof(FaultRecord)> memory{};
    auto* record = std::launder(reinterpret_cast<FaultRecord*>(memory.data()));
    record->write({.kind = wire::FaultKind::hard_fault,
                   .where = 0x0800'1234,
                   .called_from = 0x0800'5679,
                   .status = 0x8200,
                   .address = 0xDEAD'BEEF,
                   .uptime = {123'456}});
    const auto kept = record->read();
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->kind, wire::FaultKind::hard_fault);
    EXPECT_EQ(kept->where, 0x0800'1234U);
    EXPECT_EQ(kept->called_from, 0x0800'5679U);
    EXPECT_EQ(kept->status, 0x8200U);
    EXPECT_EQ(kept->address, 0xDEAD'BEEFU);
    EXPECT_EQ(kept->uptime, NodeTime{123'456});
    for (std::size_t bit = 0; bit < 8 * memory.size(); ++bit) {
        memory[bit / 8] = static_cast<unsigned char>(memory[bit / 8] ^ (1U << (bit % 8)));
        EXPECT_FALSE(record->read()) << bit;
        memory[bit / 8] = static_cast<unsigned char>(memory[bit / 8] ^ (1U << (bit % 8)));
    }
    record->write({});
    EXPECT_EQ(record->read()->kind, wire::FaultKind::none);
}

// --- pins and id

TEST(Pin, changes_its_own_bits_only) {
    for (std::uint8_t number = 0; number < 16; ++number) {
        test::AddressSpace space;
        for (Address offset = 0; offset < 0x28; offset += 4) space[0x4800'0400 + offset] = 0xFFFF'FFFF;
        Pin(gpio_b, number).make_alternate(9, Drive::push_pull, Speed::high);
        const std::uint32_t two = 3U << (2 * number);
        EXPECT_EQ(space[0x4800'0400], ~two | (2U << (2 * number)));
        EXPECT_EQ(space[0x4800'0404], ~(1U << number));
        EXPECT_EQ(space[0x4800'0408], ~two | (2U << (2 * number)));
        EXPECT_EQ(space[0x4800'040C], ~two);
        const unsigned shift = 4 * (number % 8U);
        const std::uint32_t functions = ~(0xFU << shift) | (9U << shift);
        EXPECT_EQ(space[0x4800'0420], number < 8 ? functions : 0xFFFF'FFFF);
        EXPECT_EQ(space[0x4800'0424], number < 8 ? 0xFFFF'FFFF : functions);
    }
}

TEST(UniqueId, is_twelve_bytes_in_the_order_of_memory) {
    test::AddressSpace space;
    space[0x1FFF'7590] = 0x0403'0201;
    space[0x1FFF'7594] = 0x0807'0605;
    space[0x1FFF'7598] = 0x0C0B'0A09;
    EXPECT_EQ(unique_id(), (std::array<std::uint8_t, 12>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
}

}  // namespace
}  // namespace octoskin::stm32g4
