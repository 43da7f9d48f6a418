// The flashed image on emulated boards against the same node core in this process: same rig, same world, same
// noise, and what comes out must be the same, reading by reading.
#include <gmock/gmock.h>

#include <cstdio>
#include <set>

#include "tests/board/two_homes.hpp"

namespace octoskin::sim {
namespace {

constexpr std::int64_t kSameTimeUs = 200;
constexpr std::size_t kReadingsAtRest = 45;  ///< 1.5 s of the 2

/// How far two homes, or a home and the truth, are apart.
class Spread {
  public:
    void add(std::int64_t us) { sorted_.insert(std::abs(us)); }
    [[nodiscard]] std::size_t count() const { return sorted_.size(); }
    /// What this share does not exceed.
    [[nodiscard]] std::int64_t within(double share) const {
        const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted_.size() - 1));
        return *std::next(sorted_.begin(), rank);
    }
    [[nodiscard]] double share_within(std::int64_t us) const {
        const auto count = std::distance(sorted_.begin(), sorted_.upper_bound(us));
        return static_cast<double>(count) / static_cast<double>(sorted_.size());
    }
    void print(const char* what) const {
        std::printf("%s: %zu, half within %ld us, 95 %% within %ld us, all within %ld us\n", what, count(),
                    static_cast<long>(within(0.5)), static_cast<long>(within(0.95)),
                    static_cast<long>(within(1.0)));
    }

  private:
    std::multiset<std::int64_t> sorted_;
};

/// 19 is 9 behind a start. A sensor starts anew when its period is trimmed, one reading sooner or later.
std::uint8_t status_of(const wire::RangeReading& reading) {
    return reading.device_status == 19 ? std::uint8_t{9} : reading.device_status;
}
bool is_valid_status(const wire::RangeReading& reading) {
    return status_of(reading) == 9;
}

/// Of the literal comparison.
struct Differences {
    Spread capture;
    Spread window;
};

void expect_same(const JudgedReading& flashed, const JudgedReading& core, Differences& differences) {
    EXPECT_EQ(flashed.reading.zone, core.reading.zone);
    EXPECT_EQ(flashed.reading.sequence, core.reading.sequence);
    EXPECT_EQ(flashed.reading.device_status, core.reading.device_status);
    EXPECT_NEAR(flashed.reading.range_mm, core.reading.range_mm, 1);
    const std::int64_t window_us = flashed.truth.window_middle.us - core.truth.window_middle.us;
    EXPECT_LE(std::abs(window_us), kSameTimeUs);
    // Both clocks are the same function of time, and run at a rate within 100 ppm.
    const std::int64_t capture_us = window_us + flashed.error_us - core.error_us;
    EXPECT_LE(std::abs(capture_us), kSameTimeUs);
    differences.window.add(window_us);
    differences.capture.add(capture_us);
}

/// The readings up to the first trim of either home; all, if both trimmed to the same register.
std::size_t comparable(const Heard& flashed, const Heard& core, Source source) {
    const auto& readings = core.readings.at(source);
    if (std::ranges::equal(flashed.runs.at(source), core.runs.at(source), {}, &EvenRun::period_us,
                           &EvenRun::period_us))
        return readings.size();
    std::uint32_t end = UINT32_MAX;
    for (const Heard* home : {&flashed, &core}) {
        const auto& runs = home->runs.at(source);
        if (runs.size() > 1) end = std::min(end, runs[1].first - 1);
    }
    const auto is_before = [end](const JudgedReading& reading) { return reading.truth.index < end; };
    return static_cast<std::size_t>(std::ranges::count_if(readings, is_before));
}

Differences compare(const Heard& flashed, const Heard& core) {
    Differences differences;
    std::size_t whole = 0;
    for (const auto& [source, readings] : core.readings) {
        const auto& others = flashed.readings.at(source);
        const std::size_t count = comparable(flashed, core, source);
        if (count == readings.size()) {
            ++whole;
            // The last one may wait for company in its frame as the recording ends.
            EXPECT_NEAR(static_cast<double>(readings.size()), static_cast<double>(others.size()), 1.0);
        }
        for (std::size_t i = 0; i < std::min(count, others.size()); ++i) {
            SCOPED_TRACE(testing::Message() << "node " << int{source.first} << " sensor "
                                            << int{source.second} << " reading " << i);
            expect_same(others[i], readings[i], differences);
        }
    }
    std::printf("%zu of 34 sensors compared to the end\n", whole);
    differences.window.print("windows apart");
    differences.capture.print("capture times apart");
    std::printf("%.2f %% within %ld us\n", 100.0 * differences.capture.share_within(kSameTimeUs),
                static_cast<long>(kSameTimeUs));
    return differences;
}

/// Every reading tells what was true, and when within the bound told; none is left out.
Spread expect_true(const Heard& heard) {
    Spread errors;
    for (const auto& [source, readings] : heard.readings) {
        SCOPED_TRACE(testing::Message() << "node " << int{source.first} << " sensor " << int{source.second});
        for (std::size_t i = 0; i < readings.size(); ++i) {
            const JudgedReading& judged = readings[i];
            SCOPED_TRACE(testing::Message() << "reading " << i);
            errors.add(judged.error_us);
            EXPECT_LE(std::abs(judged.error_us), judged.reported_bound_us)
                << "beyond the bound that the node told";
            if (i > 0) {
                EXPECT_EQ(judged.truth.index, readings[i - 1].truth.index + 1) << "unread, or read twice";
            }
            if (!is_valid_status(judged.reading) || !judged.truth.seen.range_m) continue;
            EXPECT_NEAR(judged.reading.range_mm, *judged.truth.seen.range_m * 1000.0, 1.0);
        }
    }
    errors.print("capture times off the truth");
    return errors;
}

/// At rest what a sensor sees depends on the how-manieth ranging it is, and on nothing else.
void expect_same_at_rest(const Heard& flashed, const Heard& core) {
    for (const auto& [source, readings] : core.readings) {
        SCOPED_TRACE(testing::Message() << "node " << int{source.first} << " sensor " << int{source.second});
        const auto& others = flashed.readings.at(source);
        EXPECT_NEAR(static_cast<double>(readings.size()), static_cast<double>(others.size()), 2.0);
        for (std::size_t i = 0; i < kReadingsAtRest; ++i) {
            SCOPED_TRACE(testing::Message() << "reading " << i);
            const wire::RangeReading& reading = readings.at(i).reading;
            const wire::RangeReading& other = others.at(i).reading;
            ASSERT_EQ(reading.zone, other.zone);
            ASSERT_EQ(reading.sequence, other.sequence);
            ASSERT_EQ(status_of(reading), status_of(other));
            ASSERT_NEAR(reading.range_mm, other.range_mm, 1);
        }
    }
}

TEST(Experiment, without_trims_the_flashed_image_says_what_the_node_core_says) {
    const TwoHomes homes({.factor_min = 1.075, .factor_max = 1.075});  // what the driver allows for
    const Heard flashed = homes.run_flashed();
    EXPECT_EQ(flashed.summary.violations, "");
    ASSERT_EQ(flashed.readings.size(), 34U);
    const Heard core = homes.run_core(flashed.summary.board_starts);
    ASSERT_EQ(core.readings.size(), 34U);

    const Differences differences = compare(flashed, core);
    EXPECT_GT(differences.capture.count(), 34U * 120U);
    expect_true(flashed);
    expect_true(core);
}

TEST(Experiment, with_real_oscillators_it_says_the_same_until_the_homes_trim_apart) {
    const TwoHomes homes(SlowClockSpread{});
    const Heard flashed = homes.run_flashed();
    EXPECT_EQ(flashed.summary.violations, "");
    ASSERT_EQ(flashed.readings.size(), 34U);
    const Heard core = homes.run_core(flashed.summary.board_starts);
    ASSERT_EQ(core.readings.size(), 34U);

    const Differences differences = compare(flashed, core);
    EXPECT_GT(differences.capture.count(), 34U * 64U) << "most sensors are to be trimmed alike";
    expect_same_at_rest(flashed, core);
    const Spread of_flashed = expect_true(flashed);
    const Spread of_core = expect_true(core);
    EXPECT_LE(of_flashed.within(0.95), of_core.within(0.95) + 100);
    EXPECT_LE(of_flashed.within(0.5), of_core.within(0.5) + 30);
}

}  // namespace
}  // namespace octoskin::sim
