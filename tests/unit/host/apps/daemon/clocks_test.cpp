#include "host/apps/daemon/clocks.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace octoskin {
namespace {

constexpr Nanoseconds kUs{1'000};
constexpr Nanoseconds kMs{1'000'000};

/// Two clocks that advance by 1 us with each reading; before some readings this thread loses the processor.
class Machine {
  public:
    /// `lost`: before the reading of this number, for so long.
    explicit Machine(std::vector<Nanoseconds> lost) : lost_(std::move(lost)) {}
    [[nodiscard]] ClockReaders readers() {
        return {[this] { return HostTime{} + pass(); }, [this] { return WallTime{kAhead + pass().count()}; }};
    }
    static constexpr std::int64_t kAhead = 1'700'000'000'000'000'000;

  private:
    Nanoseconds pass() {
        now_ += kUs + (reading_ < lost_.size() ? lost_[reading_] : Nanoseconds{0});
        ++reading_;
        return now_;
    }
    std::vector<Nanoseconds> lost_;
    std::size_t reading_ = 0;
    Nanoseconds now_{0};
};

TEST(Clocks, tell_when_a_stamp_was_wherever_this_thread_loses_the_processor) {
    for (std::size_t at = 0; at < 6; ++at) {
        std::vector<Nanoseconds> lost(6);
        lost[at] = 40 * kMs;
        Machine machine(lost);
        const WallTime stamp{Machine::kAhead - 5'000'000};
        const auto when = monotonic_of(stamp, machine.readers());
        ASSERT_TRUE(when) << at;
        EXPECT_NEAR(static_cast<double>(when->ns), -5e6, 1e3) << at;
    }
}

TEST(Clocks, tell_nothing_while_they_cannot_be_read_together) {
    Machine machine(std::vector<Nanoseconds>(100, kMs));
    EXPECT_FALSE(monotonic_of({Machine::kAhead}, machine.readers()));
    Machine busy(std::vector<Nanoseconds>(100, 100 * kUs));
    EXPECT_TRUE(monotonic_of({Machine::kAhead}, busy.readers()));
}

TEST(Clocks, take_no_stamp_of_another_time) {
    for (const std::int64_t age_ms : {-3'600'000, -1, 1'000, 3'600'000}) {
        Machine machine({});
        EXPECT_FALSE(monotonic_of({Machine::kAhead - age_ms * 1'000'000}, machine.readers())) << age_ms;
    }
    EXPECT_TRUE(monotonic_of(wall_now()));
}

}  // namespace
}  // namespace octoskin
