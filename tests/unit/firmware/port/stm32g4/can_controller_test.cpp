#include "firmware/port/stm32g4/can_controller.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <set>
#include <vector>

#include "firmware/port/stm32g4/rate_search.hpp"
#include "tests/support/stm32g4/address_space.hpp"

namespace octoskin::stm32g4 {
namespace {

using wire::CanFrame;

constexpr wire::NodeId kNode = 7;
constexpr std::uint32_t kClock = 80'000'000;
constexpr Address kBase = 0x4000'6400;
constexpr Address kCccr = kBase + 0x18;
constexpr Address kPsr = kBase + 0x44;
constexpr Address kIr = kBase + 0x50;
constexpr Address kRxf0s = kBase + 0x90;
constexpr Address kRxf0a = kBase + 0x94;
constexpr Address kTxfqs = kBase + 0xC4;
constexpr Address kTxbrp = kBase + 0xC8;
constexpr Address kTxbar = kBase + 0xCC;
constexpr Address kTxbcr = kBase + 0xD0;
constexpr Address kTxbto = kBase + 0xD4;
constexpr std::uint32_t kBusOff = 1U << 7U;
constexpr std::uint32_t kPassive = 1U << 5U;

// Three that may wait together: the last place is for REFLEX.
constexpr std::array<std::uint32_t, 3> kIds = {0x145, 0x205, 0x005};

/// The hardware's FIFOs and its request bits, as RM0440 has them.
class CanControllerTest : public ::testing::Test {
  protected:
    CanControllerTest() {
        space_[kCccr] = 1;
        space_.on_write(kTxbar, [this](std::uint32_t&, std::uint32_t request) {
            space_[kTxbrp] |= request;
            space_[kTxbto] &= ~request;
            update_queue();
        });
        space_.on_write(kTxbcr, [](std::uint32_t& cancelled, std::uint32_t value) { cancelled |= value; });
        space_.on_write(kIr, [](std::uint32_t& flags, std::uint32_t value) { flags &= ~value; });
        space_.on_write(kRxf0a, [this](std::uint32_t&, std::uint32_t index) {
            EXPECT_EQ(index, received_get_);
            received_get_ = (received_get_ + 1) % 3;
            --received_;
            update_fifo();
        });
        space_.time_us() = 0;
    }
    /// As a queue: the put index is the lowest free place.
    void update_queue() {
        const auto put = static_cast<std::uint32_t>(std::countr_one(space_[kTxbrp]));
        space_[kTxfqs] = put < 3 ? put << 16U : 1U << 21U;
    }
    void update_fifo() { space_[kRxf0s] = received_ | (received_get_ << 8U); }
    /// The bus took the frame at this place.
    void end_sent(std::uint32_t place) {
        space_[kTxbto] |= 1U << place;
        end_cancelled(place);
    }
    /// The hardware confirms that it was cancelled.
    void end_cancelled(std::uint32_t place) {
        space_[kTxbrp] &= ~(1U << place);
        update_queue();
    }
    void arrive(const CanFrame& frame) {
        const std::uint32_t index = (received_get_ + received_) % 3;
        const CanElement element = encode_element(frame);
        for (std::uint32_t i = 0; i < element.size(); ++i) {
            space_[element_address(kReceiveFifo, index) + 4 * i] = element[i];
        }
        ++received_;
        update_fifo();
        space_[kIr] |= 1;
    }
    static CanFrame frame(std::uint32_t id, std::uint8_t first) {
        CanFrame result{.can_id = id, .payload_len = 8};
        result.data[0] = first;
        return result;
    }

    test::AddressSpace space_;
    MicrosecondTimer timer_;
    CanController can_{timer_};
    CanRates rates_{.nominal = 1'000'000, .data = 5'000'000, .has_fd = true};
    std::uint32_t received_ = 0;
    std::uint32_t received_get_ = 0;
};

TEST_F(CanControllerTest, joins_with_the_rates_of_the_configuration) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    EXPECT_EQ(space_[kBase + 0x1C], (15U << 25U) | (62U << 8U) | 15U);             // 1 Mbit/s
    EXPECT_EQ(space_[kBase + 0x0C], (1U << 23U) | (10U << 8U) | (3U << 4U) | 3U);  // 5 Mbit/s
    EXPECT_EQ(space_[kBase + 0x48], 12U << 8U);
    EXPECT_EQ(space_[kCccr] & 1U, 0U) << "off INIT";
    EXPECT_EQ(space_[kCccr] & 0x300U, 0x300U) << "FD, with rate switch";
    EXPECT_EQ(space_[kBase + 0x80], (2U << 16U) | (2U << 4U) | (2U << 2U) | 1U);
    EXPECT_EQ(space_[0x4000'A400], (1U << 30U) | (1U << 27U) | (0x040U << 16U) | 0x0FFU);
    EXPECT_EQ(space_[0x4000'A404], (2U << 30U) | (1U << 27U) | (7U << 16U) | 0x3FU);
    EXPECT_EQ(can_.state(), node::CanState::active);
}

TEST_F(CanControllerTest, zeroes_its_whole_message_ram_and_no_more) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    std::set<Address> zeroed;
    for (const auto& write : space_.writes()) {
        const bool is_behind = write.address >= 0x4000'A400 && write.address < 0x4800'0000;
        if (is_behind && write.value == 0) zeroed.insert(write.address);
    }
    EXPECT_EQ(zeroed.size(), 0x350U / 4);
    EXPECT_EQ(*zeroed.rbegin(), 0x4000'A74CU);
}

TEST_F(CanControllerTest, speaks_classical_can_only_if_told_so) {
    rates_.has_fd = false;
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    EXPECT_EQ(space_[kCccr] & 0x300U, 0U);
}

TEST_F(CanControllerTest, stays_silent_without_a_clock_or_a_rate) {
    EXPECT_FALSE(can_.start(rates_, kNode, 0));
    rates_.data = 7'000'000;
    EXPECT_FALSE(can_.start(rates_, kNode, kClock));
    EXPECT_TRUE(space_.writes().empty()) << "not a register touched";
    EXPECT_FALSE(can_.send(frame(0x145, 1)));
    EXPECT_EQ(can_.state(), node::CanState::passive);
    can_.restart();
    can_.discard();
    EXPECT_FALSE(can_.take_given_up());
    can_.poll(NodeTime{1'000'000});
    EXPECT_TRUE(space_.writes().empty());
}

TEST_F(CanControllerTest, gives_up_if_the_controller_does_not_follow) {
    space_.on_write(kCccr, [](std::uint32_t& word, std::uint32_t value) { word = value | 1U; });
    EXPECT_FALSE(can_.start(rates_, kNode, kClock));
    EXPECT_FALSE(can_.is_started());
}

TEST_F(CanControllerTest, gives_three_frames_of_three_identifiers_to_a_queue_and_refuses_the_fourth) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    EXPECT_EQ(space_[kBase + 0xC0], 1U << 24U) << "the lowest identifier first";
    space_.forget_writes();
    for (std::uint8_t i = 0; i < 3; ++i) EXPECT_TRUE(can_.send(frame(kIds[i], i)));
    EXPECT_FALSE(can_.send(frame(0x006, 9)));
    EXPECT_EQ(space_.written_to(kTxbar), (std::vector<std::uint32_t>{1, 2, 4}));
    for (std::uint32_t i = 0; i < 3; ++i) {
        EXPECT_EQ(space_[0x4000'A678 + 72 * i], kIds[i] << 18U);
        EXPECT_EQ(space_[0x4000'A678 + 72 * i + 8], i);
    }
    end_sent(0);
    EXPECT_FALSE(can_.send(frame(0x145, 3))) << "a place is for REFLEX";
    end_sent(2);
    EXPECT_TRUE(can_.send(frame(0x145, 3)));
    EXPECT_EQ(space_[0x4000'A678 + 8], 3U);
}

// The hardware does not promise an order among equal identifiers.
TEST_F(CanControllerTest, has_never_two_frames_of_one_identifier_waiting) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    ASSERT_TRUE(can_.send(frame(0x145, 1)));
    EXPECT_FALSE(can_.send(frame(0x145, 2)));
    can_.poll(NodeTime{100'000});
    EXPECT_FALSE(can_.send(frame(0x145, 2))) << "taken back, but it may be on the wire";
    end_sent(0);
    EXPECT_TRUE(can_.send(frame(0x145, 2)));
}

TEST_F(CanControllerTest, has_room_for_a_reflex_whatever_else_waits) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    ASSERT_TRUE(can_.send(frame(0x705, 1)));
    ASSERT_TRUE(can_.send(frame(0x205, 1)));
    EXPECT_FALSE(can_.send(frame(0x145, 1)));
    EXPECT_TRUE(can_.send(frame(0x005, 1)));
    EXPECT_FALSE(can_.send(frame(0x005, 2)));
}

TEST_F(CanControllerTest, fills_the_place_before_it_asks_for_it) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    space_.forget_writes();
    ASSERT_TRUE(can_.send(frame(0x145, 1)));
    EXPECT_EQ(space_.writes().back().address, kTxbar);
}

TEST_F(CanControllerTest, takes_back_what_nobody_acknowledged) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    space_.time_us() = 1'000;
    ASSERT_TRUE(can_.send(frame(0x145, 1)));
    space_.time_us() = 2'000;
    ASSERT_TRUE(can_.send(frame(0x205, 2)));
    const NodeTime first_expires = *can_.wake_time();
    EXPECT_NEAR(first_expires.us, 21'000, 10);
    can_.poll(NodeTime{20'999});
    EXPECT_TRUE(space_.written_to(kTxbcr).empty());
    can_.poll(NodeTime{first_expires.us});
    can_.poll(NodeTime{first_expires.us + 10});
    EXPECT_EQ(space_.written_to(kTxbcr), std::vector<std::uint32_t>{1}) << "once, and only that one";
    EXPECT_FALSE(can_.take_given_up()) << "it may still go out";
    end_cancelled(0);
    EXPECT_EQ(can_.take_given_up(), frame(0x145, 1));
    EXPECT_FALSE(can_.take_given_up()) << "told once";
    EXPECT_EQ(can_.counts().given_up, 1U);
    can_.poll(NodeTime{30'000});
    EXPECT_EQ(space_.written_to(kTxbcr), (std::vector<std::uint32_t>{1, 2}));
    EXPECT_FALSE(can_.wake_time());
}

TEST_F(CanControllerTest, does_not_take_back_what_was_sent) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    ASSERT_TRUE(can_.send(frame(0x145, 1)));
    end_sent(0);
    can_.poll(NodeTime{100'000});
    EXPECT_TRUE(space_.written_to(kTxbcr).empty());
    EXPECT_FALSE(can_.take_given_up());
    EXPECT_EQ(can_.counts().given_up, 0U);
}

// It was on the wire when it was taken back, and ended well: TXBTO and TXBCF are both set.
TEST_F(CanControllerTest, believes_the_hardware_that_a_frame_taken_back_was_sent_after_all) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    ASSERT_TRUE(can_.send(frame(0x145, 1)));
    can_.poll(NodeTime{100'000});
    ASSERT_EQ(space_[kTxbcr], 1U);
    end_sent(0);
    EXPECT_FALSE(can_.take_given_up());
    EXPECT_EQ(can_.counts().given_up, 0U);
}

TEST_F(CanControllerTest, keeps_a_place_until_its_frames_end_was_told) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    for (std::uint8_t i = 0; i < 3; ++i) ASSERT_TRUE(can_.send(frame(kIds[i], i)));
    can_.poll(NodeTime{100'000});
    for (std::uint32_t place = 0; place < 3; ++place) end_cancelled(place);
    EXPECT_FALSE(can_.send(frame(0x145, 3))) << "nobody knows yet that frame 0 is lost";
    for (std::uint8_t i = 0; i < 3; ++i) EXPECT_EQ(can_.take_given_up(), frame(kIds[i], i));
    EXPECT_TRUE(can_.send(frame(0x145, 3)));
    EXPECT_FALSE(can_.take_given_up());
}

// Every way a frame can end, for each of the three places, in every order of sending and cancelling.
TEST_F(CanControllerTest, tells_of_each_frame_given_up_exactly_once) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    std::uint32_t given = 0;
    std::uint32_t lost = 0;
    std::uint32_t reported = 0;
    for (std::uint32_t pattern = 0; pattern < 512; ++pattern) {
        for (const std::uint32_t id : kIds) {
            given += can_.send(frame(id, static_cast<std::uint8_t>(pattern))) ? 1U : 0U;
        }
        if ((pattern & 64U) != 0) can_.poll(NodeTime{space_.time_us() + 100'000});
        if ((pattern & 128U) != 0) can_.discard();
        for (std::uint32_t place = 0; place < 3; ++place) {
            const bool is_pending = (space_[kTxbrp] >> place & 1U) != 0;
            const std::uint32_t fate = pattern >> (2 * place) & 3U;
            if (!is_pending || fate == 0) continue;
            if (fate == 1) {
                end_sent(place);
            } else if ((space_[kTxbcr] >> place & 1U) != 0) {
                end_cancelled(place);
                ++lost;
            }
            space_[kTxbcr] &= ~(1U << place);
        }
        if ((pattern & 256U) != 0) {
            while (can_.take_given_up()) ++reported;
        }
    }
    while (can_.take_given_up()) ++reported;
    EXPECT_GT(given, 300U);
    EXPECT_GT(lost, 50U);
    EXPECT_EQ(reported, lost);
    EXPECT_EQ(can_.counts().given_up, lost);
}

TEST_F(CanControllerTest, receives_with_the_time_of_the_interrupt) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    arrive(frame(0x040, 1));
    arrive(frame(0x0FF, 2));
    space_.time_us() = 0xFFFF'FFF0;
    EXPECT_FALSE(can_.has_event());
    can_.on_interrupt();
    EXPECT_TRUE(can_.has_event());
    EXPECT_EQ(space_[kIr], 0U);
    EXPECT_EQ(received_, 0U);
    const auto first = can_.receive();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->frame, frame(0x040, 1));
    EXPECT_EQ(first->received.us, 0xFFFF'FFF1);
    EXPECT_EQ(can_.receive()->frame, frame(0x0FF, 2));
    EXPECT_FALSE(can_.receive());
    can_.acknowledge_event();
    EXPECT_FALSE(can_.has_event());
}

TEST_F(CanControllerTest, keeps_sixteen_frames_and_counts_what_is_lost) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    for (std::uint8_t i = 0; i < 18; ++i) {
        arrive(frame(0x040, i));
        can_.on_interrupt();
    }
    space_[kIr] |= 1U << 2U;  // the hardware's own loss
    can_.on_interrupt();
    EXPECT_EQ(can_.counts().receive_lost, 3U);
    EXPECT_EQ(can_.counts().received, 16U);
    for (std::uint8_t i = 0; i < 16; ++i) EXPECT_EQ(can_.receive()->frame.data[0], i) << "the oldest stay";
    EXPECT_FALSE(can_.receive());
}

TEST_F(CanControllerTest, does_not_hang_on_a_fifo_that_never_empties) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    space_.on_write(kRxf0a, [](std::uint32_t&, std::uint32_t) {});
    arrive(frame(0x040, 1));
    can_.on_interrupt();
    EXPECT_LE(can_.counts().received, 6U);
}

TEST_F(CanControllerTest, tells_its_error_states_apart) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    space_[kPsr] = kPassive;
    EXPECT_EQ(can_.state(), node::CanState::passive);
    EXPECT_TRUE(can_.send(frame(0x145, 1))) << "passive is no reason to be silent";
    space_[kPsr] = kPassive | kBusOff;
    EXPECT_EQ(can_.state(), node::CanState::bus_off);
    EXPECT_FALSE(can_.send(frame(0x145, 1)));
}

TEST_F(CanControllerTest, comes_back_from_bus_off_when_told_and_sends_nothing_old) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    ASSERT_TRUE(can_.send(frame(0x145, 1)));
    ASSERT_TRUE(can_.send(frame(0x205, 2)));
    space_[kPsr] = kBusOff;
    space_[kCccr] |= 1;  // the hardware does both
    can_.discard();
    EXPECT_EQ(space_[kTxbcr], 3U);
    end_cancelled(0);
    end_cancelled(1);
    EXPECT_EQ(can_.take_given_up(), frame(0x145, 1));
    EXPECT_EQ(can_.take_given_up(), frame(0x205, 2));
    can_.discard();
    EXPECT_FALSE(can_.take_given_up()) << "each frame is given up once";
    space_.forget_writes();
    can_.restart();
    EXPECT_EQ(space_[kCccr] & 1U, 0U);
    can_.restart();
    EXPECT_EQ(space_.written_to(kCccr).size(), 1U) << "it is on its way already";
    EXPECT_EQ(can_.state(), node::CanState::bus_off);
    space_[kPsr] = 0;
    EXPECT_EQ(can_.state(), node::CanState::active);
    can_.restart();
    EXPECT_EQ(space_.written_to(kCccr).size(), 1U);
}

// MRAF, restricted operation (CCCR.ASM), or off the bus without bus-off: each alone is enough.
TEST_F(CanControllerTest, falls_silent_when_it_failed_and_tells_for_a_second_after_it_was_mended) {
    const auto fail = [this](int how) {
        if (how == 0) {
            EXPECT_NE(space_[kBase + 0x54] & (1U << 14U), 0U) << "enabled";
            space_[kIr] |= 1U << 14U;
            can_.on_interrupt();
        } else {
            space_[kCccr] |= how == 1 ? 4U : 1U;
        }
    };
    for (const int how : {0, 1, 2}) {
        SCOPED_TRACE(how);
        ASSERT_TRUE(can_.start(rates_, kNode, kClock));
        const std::uint32_t failed_before = can_.counts().failed;
        ASSERT_TRUE(can_.send(frame(0x145, 1)));
        const NodeTime now{space_.time_us() + 1'000'000};
        can_.poll(now);
        ASSERT_EQ(can_.state(), node::CanState::active);
        while (can_.take_given_up()) {
        }
        end_cancelled(0);
        end_cancelled(1);
        end_cancelled(2);
        while (can_.take_given_up()) {
        }
        ASSERT_TRUE(can_.send(frame(0x145, 2)));
        fail(how);
        can_.poll(now);
        EXPECT_FALSE(can_.is_started());
        EXPECT_EQ(can_.counts().failed, failed_before + 1);
        EXPECT_EQ(space_[kCccr] & 1U, 1U) << "INIT";
        EXPECT_FALSE(can_.send(frame(0x145, 3)));
        EXPECT_EQ(can_.state(), node::CanState::passive);
        can_.poll(now);
        EXPECT_EQ(can_.counts().failed, failed_before + 1) << "once";

        ASSERT_TRUE(can_.start(rates_, kNode, kClock));
        EXPECT_EQ(space_[kCccr] & 0x5U, 0U) << "neither INIT nor ASM";
        EXPECT_EQ(can_.take_given_up(), frame(0x145, 2)) << "setting CCE forgot it";
        space_[kTxbrp] = 0;
        update_queue();
        can_.poll(now + Microseconds{999'999});
        EXPECT_EQ(can_.state(), node::CanState::passive) << "so that a heartbeat says it";
        can_.poll(now + Microseconds{1'000'000});
        EXPECT_EQ(can_.state(), node::CanState::active);
    }
}

TEST_F(CanControllerTest, does_not_take_bus_off_for_a_failure) {
    ASSERT_TRUE(can_.start(rates_, kNode, kClock));
    space_[kPsr] = kBusOff;
    space_[kCccr] |= 1U;
    can_.poll(NodeTime{1'000'000});
    EXPECT_TRUE(can_.is_started());
    EXPECT_EQ(can_.counts().failed, 0U);
    EXPECT_EQ(can_.state(), node::CanState::bus_off);
}

TEST_F(CanControllerTest, listens_without_taking_part_then_joins) {
    ASSERT_TRUE(can_.listen(rates_, kNode, kClock));
    EXPECT_EQ(space_[kCccr] & 0x21U, 0x20U) << "MON, off INIT";
    EXPECT_EQ((space_[kBase + 0x80] >> 4U) & 3U, 0U) << "hears all";
    EXPECT_FALSE(can_.is_started());
    EXPECT_FALSE(can_.send(frame(0x145, 1)));
    arrive(frame(0x7FF, 1));
    can_.on_interrupt();
    EXPECT_EQ(can_.heard().frames, 1U);
    EXPECT_FALSE(can_.heard().has_errors);
    for (const std::uint32_t error : {1U << 21U, 1U << 22U}) {
        ASSERT_TRUE(can_.listen(rates_, kNode, kClock));
        EXPECT_EQ(can_.heard().frames, 0U);
        space_[kIr] = error;
        EXPECT_NE(space_[kBase + 0x54] & error, 0U) << "enabled";
        can_.on_interrupt();
        EXPECT_TRUE(can_.heard().has_errors);
    }
    ASSERT_TRUE(can_.join());
    EXPECT_EQ(space_[kCccr] & 0x21U, 0U);
    EXPECT_EQ((space_[kBase + 0x80] >> 4U) & 3U, 2U);
    EXPECT_TRUE(can_.send(frame(0x145, 1)));
    EXPECT_FALSE(can_.join()) << "once";
}

TEST(RateSearch, joins_only_where_frames_came_and_no_error) {
    RateSearch search;
    search.begin(NodeTime{0xFFFF'F000});
    const NodeTime end{0xFFFF'F000 + 1'500'000};
    using NextStep = RateSearch::NextStep;
    EXPECT_EQ(search.judge({.frames = 100, .has_errors = false}, NodeTime{0xFFFF'F001}), NextStep::wait);
    EXPECT_EQ(search.judge({.frames = 100, .has_errors = false}, end), NextStep::found);
    EXPECT_EQ(search.judge({.frames = 2, .has_errors = false}, end), NextStep::try_next) << "hardly anybody";
    EXPECT_EQ(search.judge({.frames = 100, .has_errors = true}, end), NextStep::try_next);
}

TEST(RateSearch, tries_every_pair_in_turn_and_each_can_be_made) {
    RateSearch search;
    std::set<CanRates> tried;
    for (int i = 0; i < 5; ++i) {
        EXPECT_TRUE(is_possible(search.rates(), kClock));
        EXPECT_TRUE(tried.insert(search.rates()).second) << "each once";
        (void)search.judge({.frames = 0, .has_errors = true}, NodeTime{0});
    }
    EXPECT_TRUE(tried.contains(search.rates())) << "and then from the start";
}

}  // namespace
}  // namespace octoskin::stm32g4
