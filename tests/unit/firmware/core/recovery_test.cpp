#include "firmware/core/recovery.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace octoskin::node {
namespace {

constexpr Policy kPolicy;

constexpr NodeTime kNow{5'000'000};

TEST(Recovery, first_restarts_a_sensor_that_still_answers) {
    Recovery recovery{kPolicy};
    const RecoveryPlan plan = recovery.on_failure(true, kNow);
    EXPECT_EQ(plan.step, RecoveryStep::restart);
    EXPECT_EQ(plan.at, kNow);
}

TEST(Recovery, cycles_xshut_at_once_when_the_sensor_does_not_answer) {
    Recovery recovery{kPolicy};
    const RecoveryPlan plan = recovery.on_failure(false, kNow);
    EXPECT_EQ(plan.step, RecoveryStep::xshut_cycle);
    EXPECT_EQ(plan.at, kNow);
}

TEST(Recovery, doubles_the_wait_between_cycles_up_to_ten_seconds) {
    Recovery recovery{kPolicy};
    (void)recovery.on_failure(true, kNow);
    std::vector<std::int64_t> waits_ms;
    for (int i = 0; i < 10; ++i) {
        const RecoveryPlan plan = recovery.on_failure(true, kNow);
        EXPECT_EQ(plan.step, RecoveryStep::xshut_cycle);
        waits_ms.push_back(elapsed(kNow, plan.at).count() / 1'000);
    }
    EXPECT_EQ(waits_ms,
              (std::vector<std::int64_t>{0, 100, 200, 400, 800, 1'600, 3'200, 6'400, 10'000, 10'000}));
}

TEST(Recovery, starts_over_only_after_ten_proven_readings_in_a_row) {
    Recovery recovery{kPolicy};
    (void)recovery.on_failure(true, kNow);
    for (int i = 0; i < 9; ++i) recovery.on_proven_reading();
    EXPECT_EQ(recovery.on_failure(true, kNow).step, RecoveryStep::xshut_cycle);
    for (int i = 0; i < 9; ++i) recovery.on_proven_reading();
    EXPECT_EQ(recovery.on_failure(true, kNow).step, RecoveryStep::xshut_cycle) << "they were not in a row";
    for (int i = 0; i < 10; ++i) recovery.on_proven_reading();
    EXPECT_EQ(recovery.on_failure(true, kNow).step, RecoveryStep::restart);
}

}  // namespace
}  // namespace octoskin::node
