// The can.log of an imported bag, and CAN frames as messages.
#include "host/bridge/mcap/bag_log.hpp"

#include <gmock/gmock.h>

#include <array>
#include <functional>
#include <limits>

#include "common/wire/codec.hpp"
#include "common/wire/frame_type.hpp"
#include "host/bridge/mcap/bag_survey.hpp"
#include "host/bridge/mcap/bag_time.hpp"
#include "host/bridge/mcap/can_messages.hpp"
#include "host/bridge/mcap/mcap_topics.hpp"
#include "host/bridge/mcap/topic_choice.hpp"
#include "host/io/candump/log_reader.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::bridge {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kStart = 1'700'000'000'000'000'000;
constexpr Nanoseconds kOffset{kStart - 100'000 * kMs};

WallTime at(std::int64_t ms) {
    return {kStart + ms * kMs};
}

wire::CanFrame frame(std::uint8_t value) {
    wire::CanFrame made{.can_id = 0x123, .payload_len = 1};
    made.data[0] = value;
    return made;
}

class BagLogTest : public testing::Test {
  protected:
    BagLog log(bool makes_sync, double rate_hz = 100.0) {
        auto writer = candump::LogWriter::create(folder_ / "can.log");
        EXPECT_TRUE(writer);
        return {std::move(writer).value(), BusClock(kOffset), makes_sync, {LocalJoints(3, 1, rate_hz)}};
    }
    std::vector<candump::LogEntry> entries(BagLog& log) {
        EXPECT_TRUE(log.close());
        auto reader = candump::LogReader::open(folder_ / "can.log");
        std::vector<candump::LogEntry> all;
        for (auto entry = reader->next(); entry && *entry; entry = reader->next()) all.push_back(**entry);
        return all;
    }
    testing_support::ScratchFolder folder_;
};

std::vector<int> values_of(const std::vector<candump::LogEntry>& entries) {
    std::vector<int> values;
    for (const auto& entry : entries) values.push_back(entry.frame.data[0]);
    return values;
}

TEST_F(BagLogTest, sorts_entries_that_come_within_a_second_of_later_ones) {
    BagLog made = log(false);
    for (const std::int64_t ms : {30, 10, 20, 40}) {
        made.advance(at(40));
        made.add(at(ms), frame(static_cast<std::uint8_t>(ms)));
    }
    made.advance(at(2'000));
    made.add(at(5), frame(50));  // too late: after those that are written, with their time
    const auto found = entries(made);
    EXPECT_THAT(values_of(found), ElementsAre(10, 20, 30, 40, 50));
    EXPECT_EQ(found.back().stamp, at(40));
    EXPECT_EQ(made.frames(), 5U);
}

TEST_F(BagLogTest, exchanges_ten_times_a_second_on_a_bag_without_a_bus) {
    BagLog made = log(true);
    for (int i = 0; i <= 50; ++i) made.add(at(20 * i), 0, {0.1});
    int syncs = 0;
    int reports = 0;
    std::vector<std::uint64_t> host_us;
    for (const auto& entry : entries(made)) {
        const auto decoded = wire::decode(entry.frame);
        ASSERT_TRUE(decoded);
        syncs += std::holds_alternative<wire::Sync>(decoded->message) ? 1 : 0;
        reports += std::holds_alternative<wire::SyncReport>(decoded->message) ? 1 : 0;
        if (const auto* follow_up = std::get_if<wire::FollowUp>(&decoded->message))
            host_us.push_back(follow_up->host_time_us);
    }
    EXPECT_EQ(syncs, 11);
    EXPECT_EQ(reports, 11);
    ASSERT_EQ(host_us.size(), 11U);
    EXPECT_EQ(host_us.front(), 100'000'000U);  // the first message is at 100 s of the bus
    EXPECT_NEAR(static_cast<double>(host_us.back()), 101e6, 1e3);
}

TEST_F(BagLogTest, exchanges_between_images_too) {
    BagLog made = log(true);
    for (int i = 0; i <= 5; ++i) made.add(at(200 * i));
    EXPECT_EQ(entries(made).size(), 11U * 3U);
}

TEST_F(BagLogTest, answers_the_sync_of_a_bags_own_host) {
    BagLog made = log(false);
    made.add(at(0), wire::encode(wire::Sync{7}, wire::kHostId));
    const auto found = entries(made);
    ASSERT_EQ(found.size(), 2U);
    const auto report = wire::decode(found[1].frame);
    ASSERT_TRUE(report);
    EXPECT_EQ(std::get<wire::SyncReport>(report->message).sequence, 7);
}

TEST_F(BagLogTest, leaves_out_samples_that_follow_too_soon_for_the_rig) {
    BagLog made = log(false);
    for (int i = 0; i < 10; ++i) made.add(at(2 * i), 0, {0.1});  // 500 Hz in place of 100
    (void)entries(made);
    EXPECT_EQ(made.frames(), 3U * 4U);  // at 0, 8 and 16 ms
    EXPECT_EQ(made.thinned(), 7U);
}

TEST_F(BagLogTest, does_not_fill_a_hole_in_the_bag) {
    BagLog made = log(true);
    made.add(at(0), 0, {0.1});
    made.add(at(2'500), 0, {0.1});
    made.add(at(3'600'000), 0, {0.1});
    EXPECT_EQ(entries(made).size(), 3U * (3U + 4U));  // of each an exchange and a sample
}

constexpr std::int64_t kYear_ms = std::int64_t{365} * 24 * 3600 * 1000;
constexpr std::int64_t kInt64Min = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kInt64Max = std::numeric_limits<std::int64_t>::max();

TEST_F(BagLogTest, takes_no_time_that_its_made_bus_cannot_hold) {
    BagLog made = log(true);
    EXPECT_TRUE(made.add(at(0), frame(1)));
    for (const WallTime stamp : {at(-101'000), at(9 * kYear_ms), WallTime{0}, WallTime{-1},
                                 WallTime{kInt64Min}, WallTime{kInt64Max}}) {
        made.advance(stamp);
        EXPECT_FALSE(made.add(stamp, frame(2))) << stamp.ns;
        EXPECT_FALSE(made.add(stamp, 0, {0.1})) << stamp.ns;
        EXPECT_FALSE(made.add(stamp)) << stamp.ns;
    }
    EXPECT_TRUE(made.add(at(8 * kYear_ms), 0, {0.1}));
    (void)entries(made);
    EXPECT_EQ(made.last()->ns / kMs, at(8 * kYear_ms).ns / kMs);
}

TEST_F(BagLogTest, keeps_frames_of_a_bags_own_bus_after_its_clock_was_set) {
    BagLog made = log(false);
    EXPECT_TRUE(made.add(at(0), wire::encode(wire::Sync{7}, wire::kHostId)));
    EXPECT_TRUE(made.add(at(20 * kYear_ms), wire::encode(wire::Sync{8}, wire::kHostId)));
    EXPECT_FALSE(made.add(at(20 * kYear_ms), 0, {0.1}));
    EXPECT_FALSE(made.add(WallTime{-1}, frame(1)));
    EXPECT_FALSE(made.add(WallTime{kInt64Max}, frame(1)));
    EXPECT_EQ(entries(made).size(), 3U);  // the second SYNC without a report: it could not have its time
}

TEST(FirstOfMost, is_that_of_the_longest_run_which_a_bus_can_hold) {
    FirstOfMost none;
    EXPECT_EQ(none.first(), std::nullopt);
    FirstOfMost first;
    first.take({30 * 1000 * kMs});  // 1970, before the clock was set
    EXPECT_EQ(first.first(), (WallTime{30 * 1000 * kMs}));
    for (int i = 0; i < 3; ++i) first.take(at(i));
    first.take({std::int64_t{1} << 62});
    EXPECT_EQ(first.first(), at(0));
}

TEST(CanMessages, hold_every_frame_and_give_it_back) {
    wire::CanFrame classical{.can_id = 0x1ABCDEF0, .is_extended = true, .payload_len = 8};
    classical.data = {1, 2, 3, 4, 5, 6, 7, 8};
    EXPECT_EQ(can_frame(can_message(classical, at(0), "can0")), classical);
    const wire::CanFrame remote{.can_id = 5, .is_remote = true, .payload_len = 4};
    EXPECT_EQ(can_frame(can_message(remote, at(0), "can0")), remote);
    for (const std::uint8_t length : std::array<std::uint8_t, 5>{0, 8, 12, 48, 64}) {
        wire::CanFrame fd{.can_id = 0x7FF, .is_fd = true, .has_bit_rate_switch = true, .payload_len = length};
        for (std::uint8_t i = 0; i < length; ++i) fd.data[i] = i;
        EXPECT_EQ(can_frame(can_fd_message(fd, at(0), "can0")), fd);
    }
}

TEST(CanMessages, refuse_what_no_frame_is) {
    const auto good = can_message(frame(1), at(0), "can0");
    for (auto change : std::vector<std::function<void(ros::can_msgs::Frame&)>>{
             [](auto& one) { one.dlc = 9; }, [](auto& one) { one.id = 0x800; },
             [](auto& one) { one.is_error = true; },
             [](auto& one) {
                 one.is_extended = true;
                 one.id = 0x20000000;
             }}) {
        auto bad = good;
        change(bad);
        EXPECT_FALSE(can_frame(bad));
    }
    wire::CanFrame fd = frame(1);
    fd.is_fd = true;
    auto message = can_fd_message(fd, at(0), "can0");
    message.len = 9;
    EXPECT_FALSE(can_frame(message));
    message.len = 2;  // more than its data
    EXPECT_FALSE(can_frame(message));
}

TEST(TimeOfAMessage, is_its_stamp_unless_that_is_of_another_clock) {
    EXPECT_EQ(time_of(at(900), at(0), false), at(900));
    EXPECT_EQ(time_of(at(-900), at(0), false), at(-900));
    EXPECT_EQ(time_of(at(1'001), at(0), false), std::nullopt);
    EXPECT_EQ(time_of(at(-1'001), at(0), false), std::nullopt);
    EXPECT_EQ(time_of({0}, at(0), false), at(0));
    EXPECT_EQ(time_of(at(5'000), at(0), true), at(0));
}

TEST(TimeOfAMessage, is_none_of_a_log_time_that_no_log_can_hold) {
    for (const std::int64_t logged : {kInt64Min, std::int64_t{-1}, kInt64Max}) {
        EXPECT_EQ(time_of({0}, {logged}, false), std::nullopt);
        EXPECT_EQ(time_of(at(0), {logged}, false), std::nullopt);
        EXPECT_EQ(time_of(at(0), {logged}, true), std::nullopt);
    }
}

TEST(RosTime, holds_1970_to_2038_and_no_more) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    const WallTime last{std::int64_t{2'147'483'647} * kSecond + 999'999'999};
    EXPECT_TRUE(is_ros_time({0}));
    EXPECT_TRUE(is_ros_time(last));
    EXPECT_FALSE(is_ros_time({last.ns + 1}));
    EXPECT_FALSE(is_ros_time({-1}));
    EXPECT_EQ(wall_time_of(ros_time(last)), last);
    EXPECT_EQ(wall_time_of(ros_time({last.ns + 5 * kSecond})), last);
    EXPECT_EQ(wall_time_of(ros_time({-1})), (WallTime{0}));
}

TEST(TopicChoice, takes_a_topic_and_those_below_it) {
    const TopicChoice standard{.also = {"/scene"}, .left_out = {"/scene", "/can"}};
    EXPECT_TRUE(standard.takes("/other"));
    EXPECT_TRUE(standard.takes("/scene"));
    EXPECT_FALSE(standard.takes("/can"));
    const TopicChoice some{.only = {"/range"}};
    EXPECT_TRUE(some.takes("/range/n1_s0"));
    EXPECT_FALSE(some.takes("/ranges"));
    EXPECT_FALSE(some.takes("/other"));
    EXPECT_TRUE((TopicChoice{.takes_all = true, .only = {"all"}}.takes("/any")));
}

TEST(QosProfiles, are_numbers_of_the_middleware_interface) {
    const std::string latched =
        qos_profiles({ros::Reliability::reliable, ros::Durability::transient_local, 1});
    EXPECT_THAT(latched, testing::HasSubstr("depth: 1\n  reliability: 1\n  durability: 1\n"));
    const std::string stream = qos_profiles({ros::Reliability::best_effort, ros::Durability::volatile_, 5});
    EXPECT_THAT(stream, testing::HasSubstr("depth: 5\n  reliability: 2\n  durability: 2\n"));
}

}  // namespace
}  // namespace octoskin::bridge
