// Stamps as adapters write them, of frames that come every 0.3 to 2 ms.
#include "host/core/time/stamp_grain.hpp"

#include <gtest/gtest.h>

#include <random>

namespace octoskin {
namespace {

constexpr std::int64_t kGrainMsNs = 1'000'000;

/// `stamp_of`: what becomes of the true time, ns.
template <class StampOf>
Nanoseconds grain_of(StampOf stamp_of) {
    std::mt19937 random(7);
    StampGrain grain;
    std::int64_t now_ns = 1'750'000'000'000'000'000;
    for (int frame = 0; frame < 20'000; ++frame) {
        now_ns += 300'000 + static_cast<std::int64_t>(random() % 1'700'000);
        if (!grain.has_enough()) grain.take({stamp_of(now_ns)});
    }
    EXPECT_TRUE(grain.has_enough());
    return grain.grain();
}

std::int64_t up_to_whole(std::int64_t ns, std::int64_t step_ns) {
    return (ns + step_ns - 1) / step_ns * step_ns;
}

TEST(StampGrain, of_a_kernels_stamps_there_is_none) {
    EXPECT_EQ(grain_of([](std::int64_t ns) { return ns / 1000 * 1000; }).count(), 0);
    EXPECT_EQ(grain_of([](std::int64_t ns) { return up_to_whole(ns, kGrainMsNs); }).count(), 0)
        << "3 decimals";
    EXPECT_EQ(grain_of([](std::int64_t ns) { return up_to_whole(ns, 5 * kGrainMsNs); }).count(), 0)
        << "harmless";
}

TEST(StampGrain, of_batches_and_of_rounded_stamps_it_is_their_distance) {
    EXPECT_EQ(grain_of([](std::int64_t ns) { return up_to_whole(ns, 16 * kGrainMsNs); }).count(),
              16 * kGrainMsNs);
    EXPECT_EQ(
        grain_of([](std::int64_t ns) { return up_to_whole(ns, 10 * kGrainMsNs) - 10 * kGrainMsNs; }).count(),
        10 * kGrainMsNs);
    EXPECT_EQ(grain_of([](std::int64_t ns) { return up_to_whole(ns, 1000 * kGrainMsNs); }).count(),
              1000 * kGrainMsNs);
    EXPECT_EQ(grain_of([](std::int64_t ns) { return up_to_whole(ns, 60'000 * kGrainMsNs); }).count(), 0)
        << "one batch has no distance";
}

TEST(StampGrain, of_a_bus_that_falls_silent_now_and_then_there_is_none) {
    StampGrain grain;
    for (std::int64_t frame = 0; frame < 1'000; ++frame) grain.take({frame * 100 * kGrainMsNs});
    EXPECT_EQ(grain.grain().count(), 0);
}

TEST(StampGrain, is_named_with_what_mends_it) {
    EXPECT_FALSE(describe_stamps(Nanoseconds{0}));
    for (const std::int64_t ms : {16, 1000}) {
        const auto what = describe_stamps(Nanoseconds{ms * kGrainMsNs});
        ASSERT_TRUE(what);
        EXPECT_NE(what->find("steps of " + std::to_string(ms) + " ms"), std::string::npos) << *what;
        EXPECT_NE(what->find("latency_timer"), std::string::npos) << *what;
        EXPECT_NE(what->find("setserial"), std::string::npos) << *what;
        EXPECT_EQ(what->find("are bridged") != std::string::npos, ms == 16) << *what;
    }
}

}  // namespace
}  // namespace octoskin
