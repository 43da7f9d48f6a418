#include "hw/sim/board_link/message.hpp"

#include <gtest/gtest.h>

namespace octoskin::sim {
namespace {

wire::CanFrame some_frame() {
    wire::CanFrame frame{.can_id = 0x2C1, .is_fd = true, .has_bit_rate_switch = true, .payload_len = 12};
    for (std::uint8_t i = 0; i < 12; ++i) frame.data[i] = static_cast<std::uint8_t>(0xF0U + i);
    return frame;
}

template <class T>
T there_and_back(const T& message) {
    return std::get<T>(decode_message(encode_message(message)));
}

TEST(BoardLinkMessage, run_until_keeps_its_events_in_order) {
    const RunUntil back = there_and_back(RunUntil{{123'456'789'012},
                                                  {{BusEventKind::started, {7}, {}},
                                                   {BusEventKind::received, {8}, some_frame()},
                                                   {BusEventKind::disturbed, {9}, {}}}});
    EXPECT_EQ(back.time.us, 123'456'789'012);
    ASSERT_EQ(back.events.size(), 3U);
    EXPECT_EQ(back.events[0].kind, BusEventKind::started);
    EXPECT_EQ(back.events[1].frame, some_frame());
    EXPECT_EQ(back.events[2].time.us, 9);
}

TEST(BoardLinkMessage, an_offer_is_there_or_is_not) {
    EXPECT_EQ(there_and_back(HasRun{some_frame()}).offer, some_frame());
    EXPECT_EQ(there_and_back(HasRun{}).offer, std::nullopt);
}

TEST(BoardLinkMessage, what_is_seen_may_be_nothing) {
    const WhatIsSeen asked = there_and_back(WhatIsSeen{33, 70'000, {-5}, {60, 4, 8}});
    EXPECT_EQ(asked.sensor, 33);
    EXPECT_EQ(asked.ranging_index, 70'000U);
    EXPECT_EQ(asked.window_middle.us, -5);
    EXPECT_EQ(asked.roi, (Roi{60, 4, 8}));
    EXPECT_EQ(there_and_back(Seen{{.range_m = {}, .sigma_m = 0.5}}).what.range_m, std::nullopt);
    const RangingReturn seen = there_and_back(Seen{{1.25, 0.5, 20.0, 0.25}}).what;
    EXPECT_EQ(seen.range_m, 1.25);
    EXPECT_EQ(seen.sigma_m, 0.5);
    EXPECT_EQ(seen.peak_signal_mcps, 20.0);
    EXPECT_EQ(seen.ambient_mcps, 0.25);
}

TEST(BoardLinkMessage, every_truncation_is_refused) {
    const BoardMessage messages[] = {RunUntil{{1}, {{BusEventKind::received, {8}, some_frame()}}},
                                     HasRun{some_frame()},
                                     WhatIsSeen{},
                                     Seen{},
                                     AskSummary{},
                                     BoardSummary{}};
    for (const BoardMessage& message : messages) {
        std::vector<std::uint8_t> bytes = encode_message(message);
        EXPECT_EQ(decode_message(bytes).index(), message.index());
        bytes.push_back(0);
        EXPECT_THROW(static_cast<void>(decode_message(bytes)), BoardLinkError) << "one byte too many";
        bytes.pop_back();
        while (!bytes.empty()) {
            bytes.pop_back();
            EXPECT_THROW(static_cast<void>(decode_message(bytes)), BoardLinkError) << bytes.size();
        }
    }
    EXPECT_THROW(static_cast<void>(decode_message({99})), BoardLinkError);
}

}  // namespace
}  // namespace octoskin::sim
