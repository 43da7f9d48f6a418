// The oracle is a simulated node clock whose true relation to host time is known in closed form.
#include "host/core/time/clock_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

namespace octoskin {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

/// A node's counter: `start_us` at host time 0, `drift` fast, its rate swinging by `swing` with a period of
/// 60 s.
struct NodeClock {
    double start_us = 0.0;
    double drift = 0.0;
    double swing = 0.0;

    [[nodiscard]] std::int64_t count_at(HostTime host) const {
        const double t = 1e-9 * static_cast<double>(host.ns);
        const double omega = 2.0 * M_PI / 60.0;
        const double extra_s = drift * t + swing / omega * (1.0 - std::cos(omega * t));
        return static_cast<std::int64_t>(std::floor(start_us + 1e6 * (t + extra_s)));
    }
    [[nodiscard]] NodeTime at(HostTime host) const {
        return {static_cast<std::uint32_t>(static_cast<std::uint64_t>(count_at(host)))};
    }
    [[nodiscard]] wire::TimeResidue residue_at(HostTime host,
                                               std::uint32_t span_us = wire::kFdTimeSpanUs) const {
        return {at(host).us % span_us, span_us};
    }
};

HostTime at_s(double seconds) {
    return {std::llround(seconds * 1e9)};
}

/// Exchanges at 1, 2, ... `count` s without jitter.
ClockMap locked_map(const NodeClock& clock, int count, const ClockMapConfig& config = {}) {
    ClockMap map(config);
    for (int k = 1; k <= count; ++k) {
        EXPECT_EQ(map.add({at_s(k), clock.at(at_s(k))}), SampleEffect::used);
    }
    return map;
}

std::int64_t error_ns(const ClockMap& map, const NodeClock& clock, HostTime truth,
                      Nanoseconds age = Nanoseconds{20'000'000}) {
    const auto mapped = map.locate(clock.residue_at(truth), truth + age);
    EXPECT_TRUE(mapped.has_value());
    return mapped ? std::abs((mapped->time - truth).count()) : INT64_MAX;
}

TEST(ClockMap, is_usable_after_two_exchanges_once_the_second_has_settled) {
    const NodeClock clock{.start_us = 5'000'000};
    ClockMap map;
    EXPECT_EQ(map.locate(clock.residue_at(at_s(1)), at_s(1)).error(), ClockFault::not_ready);
    map.add({at_s(1), clock.at(at_s(1))});
    EXPECT_EQ(map.locate(clock.residue_at(at_s(1.5)), at_s(1.5)).error(), ClockFault::not_ready);
    map.add({at_s(2), clock.at(at_s(2))});
    EXPECT_EQ(map.locate(clock.residue_at(at_s(2.199)), at_s(2.21)).error(), ClockFault::not_ready);
    EXPECT_LE(error_ns(map, clock, at_s(2.201)), 1'000);
}

TEST(ClockMap, follows_a_clock_100_ppm_off_to_a_microsecond_without_jitter) {
    for (const double drift : {-200e-6, -100e-6, 0.0, 100e-6, 200e-6}) {
        const NodeClock clock{.start_us = 1'000, .drift = drift};
        const ClockMap map = locked_map(clock, 10);
        EXPECT_LE(error_ns(map, clock, at_s(11.0)), 2'000);
        EXPECT_NEAR(*map.drift(), 1.0 / (1.0 + drift) - 1.0, 1e-6);
    }
}

TEST(ClockMap, stays_within_half_a_millisecond_and_within_its_bound_under_jitter_drift_and_wander) {
    std::vector<std::int64_t> errors_ns;
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        const auto between = [&](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        // Node and host at +-100 ppm each; 4 ppm over 60 s swings at no more than 0.42 ppm/s.
        const NodeClock clock{
            .start_us = between(0.0, 4294967295.0), .drift = between(-200e-6, 200e-6), .swing = 4e-6};
        ClockMap map;
        for (int k = 1; k <= 30; ++k) {
            const HostTime sync = at_s(k);
            const HostTime stamped = sync + Nanoseconds{std::llround(between(-49e3, 49e3))};
            const NodeTime heard = clock.at(sync + Nanoseconds{std::llround(between(-49e3, 49e3))});
            ASSERT_EQ(map.add({stamped, heard}), SampleEffect::used);
            for (int i = 0; i < 12 && k >= 2; ++i) {
                const HostTime truth = sync + Nanoseconds{std::llround(between(0.2e9, 1.19e9))};
                const auto mapped = map.locate(clock.residue_at(truth), truth + Nanoseconds{30'000'000});
                ASSERT_TRUE(mapped.has_value());
                const std::int64_t error = std::abs((mapped->time - truth).count());
                ASSERT_LE(error, 500'000);
                ASSERT_LE(error, mapped->error_bound.count() + 1'000) << "plus the counter's own step";
                errors_ns.push_back(error);
            }
        }
    }
    std::ranges::sort(errors_ns);
    const auto share_us = [&](std::size_t percent) {
        return 1e-3 * static_cast<double>(errors_ns[(errors_ns.size() - 1) * percent / 100]);
    };
    std::printf(
        "node time to host time, both clocks up to 100 ppm off: %zu times, median %.0f us, 99 %% %.0f us, "
        "at most %.0f us off\n",
        errors_ns.size(), share_us(50), share_us(99), share_us(100));
}

TEST(ClockMap, widens_its_bound_with_silence_and_gives_up_after_five_seconds) {
    const NodeClock clock{.start_us = 0};
    const ClockMap map = locked_map(clock, 8);
    Nanoseconds last{0};
    for (double silence = 0.25; silence < 4.9; silence += 0.5) {
        const HostTime truth = at_s(8.0 + silence);
        const auto mapped = map.locate(clock.residue_at(truth), truth);
        ASSERT_TRUE(mapped.has_value()) << silence;
        EXPECT_GT(mapped->error_bound, last);
        const auto reported = map.error_bound(truth);
        ASSERT_TRUE(reported);
        EXPECT_NEAR(static_cast<double>((*reported - mapped->error_bound).count()), 0.0, 1'000.0);
        last = mapped->error_bound;
    }
    EXPECT_FALSE(map.fault(at_s(13.0)).has_value());
    EXPECT_TRUE(map.error_bound(at_s(13.0)));
    EXPECT_FALSE(map.error_bound(at_s(13.001)));
    EXPECT_FALSE(locked_map(clock, 1).error_bound(at_s(1.5)));
    EXPECT_EQ(map.locate(clock.residue_at(at_s(13.001)), at_s(13.001)).error(), ClockFault::silent);
}

TEST(ClockMap, crosses_the_wrap_of_the_counter_without_a_jump) {
    // The counter wraps at host time 5.25 s.
    const NodeClock clock{.start_us = 4'294'967'296.0 - 5'250'000.0, .drift = 50e-6};
    ASSERT_GT(clock.at(at_s(5.2)).us, clock.at(at_s(5.3)).us);
    const ClockMap map = locked_map(clock, 12);
    ClockMap half = locked_map(clock, 5);
    for (double t = 5.21; t < 6.0; t += 0.01) {
        EXPECT_LE(error_ns(half, clock, at_s(t)), 2'000) << t;
    }
    EXPECT_LE(error_ns(map, clock, at_s(12.5)), 2'000);
}

TEST(ClockMap, finds_the_reading_meant_for_every_age_a_residue_can_have) {
    const NodeClock clock{.start_us = 123'456'789.0};
    const ClockMap map = locked_map(clock, 4);
    const HostTime now = at_s(4.9);
    // 12 bits of 64 us: every age in steps of 64 us, except the slack that "now" needs.
    for (std::int64_t age_us = 0; age_us < (1 << 18) - 5'100; age_us += 64) {
        const HostTime truth = now - Microseconds{age_us};
        wire::TimeResidue residue = clock.residue_at(truth, wire::kClassicalTimeSpanUs);
        residue.value_us &= ~63U;
        const auto mapped = map.locate(residue, now);
        ASSERT_TRUE(mapped.has_value());
        ASSERT_LE(std::abs((mapped->time - truth).count()), 65'000) << age_us;
    }
}

TEST(ClockMap, resolves_a_residue_at_its_edges) {
    ClockMap map;
    // The node's counter equals the host's microseconds.
    for (int k = 1; k <= 4; ++k) {
        map.add({at_s(k), {static_cast<std::uint32_t>(k) * 1'000'000U}});
    }
    const auto node_us = [&](std::uint32_t value_us, std::int64_t now_us) {
        return map.locate({value_us, 1U << 18}, {1000 * now_us})->time.ns / 1000;
    };
    constexpr std::int64_t kTurn = 17 << 18;  // 4'456'448 us: where the residue is 0
    EXPECT_EQ(node_us(0, kTurn), kTurn);
    EXPECT_EQ(node_us(0, kTurn + 262'143 - 5'000), kTurn);
    EXPECT_EQ(node_us(0, kTurn + 262'144 - 5'000), kTurn + 262'144) << "allowed to be 5 ms early";
    EXPECT_EQ(node_us(0, kTurn - 5'000), kTurn);
    EXPECT_EQ(node_us(0, kTurn - 5'001), kTurn - 262'144);
    EXPECT_EQ(node_us(262'143, kTurn + 1), kTurn - 1);
    EXPECT_EQ(node_us(1, kTurn + 1), kTurn + 1);
}

TEST(ClockMap, ignores_a_single_wrong_exchange_but_trusts_nothing_until_the_next) {
    const NodeClock clock{.start_us = 0, .drift = 80e-6};
    ClockMap map = locked_map(clock, 5);
    EXPECT_EQ(map.add({at_s(6), clock.at(at_s(6.02))}), SampleEffect::contradicts);
    EXPECT_EQ(map.locate(clock.residue_at(at_s(6.5)), at_s(6.5)).error(), ClockFault::in_doubt);
    EXPECT_EQ(map.add({at_s(7), clock.at(at_s(7))}), SampleEffect::used);
    EXPECT_LE(error_ns(map, clock, at_s(7.5)), 2'000);
}

TEST(ClockMap, locks_again_two_exchanges_after_the_counter_jumped) {
    const NodeClock before{.start_us = 3'000'000'000.0, .drift = 80e-6};
    for (const double jump_us : {-3'005'000'000.0, -20'000.0, 20'000.0, 5'000'000.0, 1'000'000'000.0}) {
        NodeClock after = before;
        after.start_us += jump_us;
        ClockMap map = locked_map(before, 5);  // the jump comes right after the fifth
        EXPECT_EQ(map.add({at_s(6), after.at(at_s(6))}), SampleEffect::contradicts) << jump_us;
        EXPECT_EQ(map.locate(after.residue_at(at_s(6.5)), at_s(6.5)).error(), ClockFault::in_doubt);
        EXPECT_EQ(map.add({at_s(7), after.at(at_s(7))}), SampleEffect::relocked);
        EXPECT_LE(error_ns(map, after, at_s(7.3)), 2'000);
    }
}

TEST(ClockMap, is_not_relocked_by_two_wrong_exchanges_that_disagree) {
    const NodeClock clock{.start_us = 0};
    ClockMap map = locked_map(clock, 5);
    EXPECT_EQ(map.add({at_s(6), clock.at(at_s(6.02))}), SampleEffect::contradicts);
    EXPECT_EQ(map.add({at_s(7), clock.at(at_s(7.5))}), SampleEffect::contradicts);
    EXPECT_EQ(map.add({at_s(8), clock.at(at_s(8))}), SampleEffect::used);
    EXPECT_LE(error_ns(map, clock, at_s(8.3)), 2'000);
}

TEST(ClockMap, refuses_a_rate_that_no_crystal_has) {
    ClockMap map;
    map.add({at_s(1), {1'000'000}});
    EXPECT_EQ(map.add({at_s(2), {2'001'000}}), SampleEffect::contradicts) << "1000 ppm";
    EXPECT_EQ(map.add({at_s(3), {3'000'000}}), SampleEffect::used);
}

TEST(ClockMap, refuses_a_counter_that_stands_still) {
    ClockMap map;
    map.add({at_s(1), {1'000'000}});
    EXPECT_EQ(map.add({at_s(1.0001), {1'000'000}}), SampleEffect::contradicts);
}

TEST(ClockMap, allows_for_a_wandering_clock_in_its_bound) {
    ClockMapConfig config;
    config.stamp_error = Nanoseconds{2'000};
    config.wander_per_s = 5e-6;  // so that the wander is what counts: 4.2 ppm/s at most
    const NodeClock clock{.start_us = 0, .drift = 0.0, .swing = 40e-6};
    ClockMap map(config);
    std::int64_t error_max = 0;
    for (int k = 1; k <= 60; ++k) {
        ASSERT_EQ(map.add({at_s(k), clock.at(at_s(k))}), SampleEffect::used);
        const HostTime truth = at_s(k + 1.1);
        if (k >= 2) {
            const auto mapped = map.locate(clock.residue_at(truth), truth);
            ASSERT_TRUE(mapped.has_value());
            const std::int64_t error = std::abs((mapped->time - truth).count());
            EXPECT_LE(error, mapped->error_bound.count() + 1'000);
            error_max = std::max(error, error_max);
        }
    }
    EXPECT_GT(error_max, 20'000) << "more than the exchanges' own error can explain";
}

TEST(ClockMap, starts_anew_after_a_minute_without_exchange) {
    const NodeClock clock{.start_us = 0};
    ClockMap map = locked_map(clock, 5);
    EXPECT_EQ(map.add({at_s(66), {7}}), SampleEffect::used);
    EXPECT_EQ(map.fault(at_s(66)), ClockFault::not_ready);
}

TEST(ClockMap, forgets_a_node_that_restarted) {
    const NodeClock clock{.start_us = 0};
    ClockMap map = locked_map(clock, 5);
    map.forget();
    EXPECT_EQ(map.fault(at_s(5)), ClockFault::not_ready);
    EXPECT_FALSE(map.drift().has_value());
}

TEST(ClockMap, places_an_instant_the_same_whether_the_next_exchange_is_known_yet_or_not) {
    const NodeClock clock{.start_us = 0, .drift = 60e-6};
    std::mt19937 random(7);
    std::uniform_int_distribution<std::int64_t> jitter(-90'000, 90'000);
    ClockMap map;
    for (int k = 1; k <= 20; ++k) {
        const HostTime captured = at_s(k + 0.1);
        const auto early = map.locate(clock.residue_at(captured), captured + Nanoseconds{kSecondNs / 10});
        map.add({at_s(k) + Nanoseconds{jitter(random)}, clock.at(at_s(k))});
        const auto late = map.locate(clock.residue_at(captured), captured + Nanoseconds{kSecondNs / 10});
        if (k > 2) {
            ASSERT_TRUE(early.has_value() && late.has_value());
            EXPECT_EQ(early->time, late->time);
        }
    }
}

}  // namespace
}  // namespace octoskin
