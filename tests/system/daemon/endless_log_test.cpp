// The log of the experiment, round after round. Oracle: each reading is numbered as the one before it and
// one, and its node's clock has gone on by as much as the stamps, so that nobody can tell where a round
// begins.
#include "tests/support/live/endless_log.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/wire/codec.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

constexpr double kLog_s = 12.0;  // from the first frame to STOP
constexpr std::int64_t kSecond = 1'000'000'000;

/// What came before of one source of numbered messages.
struct Before {
    std::uint8_t sequence = 0;
    std::uint32_t clock_us = 0;
    std::int64_t stamp_ns = 0;
};

class Continuity {
  public:
    /// Of one source, in the order of their stamps: no two are under way for times that differ by over 20 ms.
    void expect(int source, std::uint8_t sequence, unsigned modulus, const wire::TimeResidue& time,
                WallTime stamp) {
        ++expected_;
        auto& before = before_[source];
        if (before) {
            EXPECT_EQ(sequence, (before->sequence + 1U) % modulus) << source << at(stamp);
            const std::int64_t span = time.span_us;
            const std::int64_t ran_us = std::int64_t{time.value_us} - before->clock_us;
            const std::int64_t passed_us = (stamp.ns - before->stamp_ns) / 1000;
            const std::int64_t apart_us = ((ran_us - passed_us) % span + span + span / 2) % span - span / 2;
            EXPECT_LT(std::abs(apart_us), 20'000) << source << at(stamp);
        }
        before = Before{sequence, time.value_us, stamp.ns};
        begin_ns_ = begin_ns_ ? begin_ns_ : stamp.ns;
    }
    [[nodiscard]] int expected() const { return expected_; }

  private:
    [[nodiscard]] std::string at(WallTime stamp) const {
        return " at " + std::to_string(static_cast<double>(stamp.ns - *begin_ns_) * 1e-9) + " s";
    }
    int expected_ = 0;
    std::map<int, std::optional<Before>> before_;
    std::optional<std::int64_t> begin_ns_;
};

TEST(EndlessLog, goes_on_in_time_and_number_from_round_to_round_where_the_robot_stood) {
    EndlessLog log(log_of_experiment(), {});
    Continuity continuity;
    std::optional<std::int32_t> elbow_urad;
    const std::int64_t begin_ns = log_of_experiment().front().stamp.ns;
    const auto end_ns = begin_ns + std::llround(3.0 * kLog_s * kSecond);
    for (StampedFrame entry = log.next(); entry.stamp.ns < end_ns; entry = log.next()) {
        const wire::Decoded decoded = wire::decode(entry.frame).value();
        if (const auto* range = std::get_if<wire::RangeFd>(&decoded.message)) {
            for (std::size_t i = 0; i < range->count; ++i) {
                const wire::RangeReading& reading = range->entries.at(i).reading;
                continuity.expect(100 * decoded.node_id + reading.sensor, reading.sequence, 64,
                                  reading.capture, entry.stamp);
            }
        }
        const auto* const joints = std::get_if<wire::JointState>(&decoded.message);
        if (joints == nullptr) continue;
        if (const auto* last = std::get_if<wire::JointLast>(joints))
            continuity.expect(100 * decoded.node_id, last->sequence, 8, last->sampled, entry.stamp);
        const auto* const pair = std::get_if<wire::JointPair>(joints);
        if (pair == nullptr || pair->index != 1) continue;
        const std::int32_t now_urad = pair->position_urad[1];
        EXPECT_LT(std::abs(now_urad - elbow_urad.value_or(now_urad)), 20'000) << "2 rad/s at 100 Hz";
        elbow_urad = now_urad;
    }
    EXPECT_GT(continuity.expected(), 10'000);
}

/// The clock that dates a source's messages: at which stamp it was read, and what it showed.
struct Reading {
    std::int64_t stamp_ns = 0;
    wire::TimeResidue clock;
};

/// Of each source, in the order of their stamps.
std::map<int, std::vector<Reading>> read_clocks_until(EndlessLog& log, std::int64_t end_ns) {
    std::map<int, std::vector<Reading>> read;
    for (StampedFrame entry = log.next(); entry.stamp.ns < end_ns; entry = log.next()) {
        const wire::Decoded decoded = wire::decode(entry.frame).value();
        if (const auto* range = std::get_if<wire::RangeFd>(&decoded.message))
            read[decoded.node_id].push_back({entry.stamp.ns, range->entries.at(0).reading.capture});
        const auto* const joints = std::get_if<wire::JointState>(&decoded.message);
        const auto* const last = joints != nullptr ? std::get_if<wire::JointLast>(joints) : nullptr;
        if (last != nullptr) read[decoded.node_id].push_back({entry.stamp.ns, last->sampled});
    }
    return read;
}

/// START and STOP.
std::int64_t round_ns() {
    std::vector<std::int64_t> marks_ns;
    for (const StampedFrame& entry : log_of_experiment()) {
        if (wire::type_of(entry.frame.can_id) == wire::FrameType::mark) marks_ns.push_back(entry.stamp.ns);
    }
    return marks_ns.back() - marks_ns.front();
}

TEST(EndlessLog, lets_each_node_s_clock_run_at_its_own_rate) {
    // 200 ppm is a crystal's, 1 % more than the CAN bus would bear; node 3 is not told of, and runs at 1.
    const std::map<wire::NodeId, double> rates = {{1, 0.9998}, {2, 1.01}};
    const std::map<int, double> gained_us = {{1, -2'000.0}, {2, 100'000.0}, {3, 0.0}};  // in 10 s
    EndlessLog log(log_of_experiment(), rates);
    const std::int64_t begin_ns = log_of_experiment().front().stamp.ns;
    const auto read = read_clocks_until(log, begin_ns + std::llround(4.0 * kLog_s * kSecond));
    ASSERT_EQ(read.size(), 3U);
    ASSERT_NEAR(static_cast<double>(round_ns()), 10e9, 0.1e9);
    for (const auto& [node, readings] : read) {
        int compared = 0;
        auto later = readings.begin();
        for (const Reading& earlier : readings) {  // the same message, a round apart
            while (later != readings.end() && later->stamp_ns < earlier.stamp_ns + round_ns()) ++later;
            if (later == readings.end() || later->stamp_ns != earlier.stamp_ns + round_ns()) continue;
            ++compared;
            const std::int64_t span = earlier.clock.span_us;
            const std::int64_t ran_us = std::int64_t{later->clock.value_us} - earlier.clock.value_us;
            const std::int64_t gained =
                ((ran_us - round_ns() / 1000) % span + span + span / 2) % span - span / 2;
            ASSERT_NEAR(static_cast<double>(gained),
                        gained_us.at(node) * static_cast<double>(round_ns()) * 1e-10, 2.0)
                << "node " << node << " at " << static_cast<double>(earlier.stamp_ns - begin_ns) * 1e-9
                << " s";
        }
        EXPECT_GT(compared, 500) << node;
    }
}

}  // namespace
}  // namespace octoskin::test
