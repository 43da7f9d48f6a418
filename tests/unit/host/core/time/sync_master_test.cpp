#include "host/core/time/sync_master.hpp"

#include <gtest/gtest.h>

#include "host/core/time/sync_exchange.hpp"

namespace octoskin {
namespace {

HostTime at_ms(std::int64_t ms) {
    return {ms * 1'000'000};
}

TEST(SyncMaster, sends_one_a_period_under_numbers_that_come_round) {
    SyncMaster master;
    for (int i = 0; i < 70; ++i) {
        const auto sync = master.poll(at_ms(1000 * i));
        ASSERT_TRUE(sync) << i;
        EXPECT_EQ(sync->sequence, i % wire::kSyncSequenceCount);
        EXPECT_FALSE(master.poll(at_ms(1000 * i + 999)));
        EXPECT_EQ(master.due(), at_ms(1000 * i + 1000));
    }
}

TEST(SyncMaster, does_not_make_up_for_what_it_missed) {
    SyncMaster master;
    EXPECT_TRUE(master.poll(at_ms(0)));
    EXPECT_TRUE(master.poll(at_ms(10'500)));
    EXPECT_FALSE(master.poll(at_ms(11'000)));
    EXPECT_TRUE(master.poll(at_ms(11'500)));
}

TEST(SyncMaster, follows_up_its_newest_sync_once_with_whole_microseconds) {
    SyncMaster master;
    const auto sync = master.poll(at_ms(5));
    ASSERT_TRUE(sync);
    const auto follow_up = master.on_sent(sync->sequence, {5'123'456'789});
    ASSERT_TRUE(follow_up);
    EXPECT_EQ(follow_up->sequence, sync->sequence);
    EXPECT_EQ(follow_up->host_time_us, 5'123'456U);
    EXPECT_FALSE(master.on_sent(sync->sequence, {5'123'500'000}));
}

TEST(SyncMaster, does_not_follow_up_one_that_came_on_the_bus_after_the_next_was_asked_for) {
    SyncMaster master;
    const auto first = master.poll(at_ms(0));
    const auto second = master.poll(at_ms(1000));
    ASSERT_TRUE(first && second);
    EXPECT_FALSE(master.on_sent(first->sequence, at_ms(1001)));
    EXPECT_TRUE(master.on_sent(second->sequence, at_ms(1002)));
}

TEST(SyncMaster, exchanges_with_itself_once_a_period_while_its_sync_does_not_come_onto_the_bus) {
    SyncMaster master;
    EXPECT_FALSE(master.poll_alone(at_ms(400))) << "nothing was asked for yet";
    for (int i = 1; i < 40; ++i) {
        const auto sync = master.poll(at_ms(1000 * i));
        ASSERT_TRUE(sync);
        EXPECT_FALSE(master.poll_alone(at_ms(1000 * i + 499))) << "it may still come";
        const auto alone = master.poll_alone(at_ms(1000 * i + 500));
        ASSERT_TRUE(alone);
        EXPECT_EQ(alone->sequence, (sync->sequence + 1) % wire::kSyncSequenceCount);
        EXPECT_FALSE(master.poll_alone(at_ms(1000 * i + 550)));
        EXPECT_FALSE(master.on_sent(sync->sequence, at_ms(1000 * i + 600))) << "too late";
    }
    const auto sync = master.poll(at_ms(50'000));
    ASSERT_TRUE(sync);
    EXPECT_TRUE(master.on_sent(sync->sequence, at_ms(50'001)));
    EXPECT_FALSE(master.poll_alone(at_ms(50'500))) << "somebody is there";
}

TEST(SyncMaster, sends_the_next_one_a_quarter_of_a_period_after_the_newest_when_it_is_hastened) {
    SyncMaster master;
    ASSERT_TRUE(master.poll(at_ms(1000)));
    master.hasten();
    EXPECT_FALSE(master.poll(at_ms(1249)));
    EXPECT_TRUE(master.poll(at_ms(1250)));
    ASSERT_TRUE(master.poll(at_ms(2250)));
    EXPECT_FALSE(master.poll(at_ms(2900)));
    master.hasten();
    EXPECT_TRUE(master.poll(at_ms(2900))) << "at once, if the newest was long ago";
}

TEST(SyncMaster, hurries_once_and_exchanges_with_itself_where_no_sync_comes_onto_the_bus) {
    SyncMaster master;
    int asked = 0;
    int alone = 0;
    for (int ms = 1000; ms < 26'000; ms += 50) {
        master.hasten();
        asked += master.poll(at_ms(ms)) ? 1 : 0;
        alone += master.poll_alone(at_ms(ms)) ? 1 : 0;
    }
    EXPECT_EQ(asked, 40) << "two in 1.25 s";
    EXPECT_EQ(alone, 20);
}

TEST(SyncMaster, agrees_with_the_exchange_that_everybody_sees) {
    SyncMaster master;
    SyncExchange exchange;
    for (int i = 0; i < 40; ++i) {
        const auto sync = master.poll(at_ms(1000 * i));
        ASSERT_TRUE(sync);
        ASSERT_TRUE(exchange.on_sync(*sync, WallTime{1000 + i}));
        const auto follow_up = master.on_sent(sync->sequence, at_ms(1000 * i + 1));
        ASSERT_TRUE(follow_up);
        const auto stamp = exchange.on_follow_up(*follow_up);
        ASSERT_TRUE(stamp);
        EXPECT_EQ(stamp->host, at_ms(1000 * i + 1));
    }
}

}  // namespace
}  // namespace octoskin
