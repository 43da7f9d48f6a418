// Streams of one sound driver, as odd as they come: none of their samples is a jump, and none is of a second
// sender. A failure prints its seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "host/core/ingest/joint_sender_check.hpp"
#include "host/core/ingest/local_joints.hpp"
#include "host/core/kinematics/joint_jump.hpp"

namespace octoskin {
namespace {

constexpr std::size_t kJoints = 7;

/// A trajectory that keeps turning round, each joint at its velocity limit all the time.
class Arm {
  public:
    explicit Arm(std::mt19937_64& random) {
        std::uniform_real_distribution<double> velocity(0.1, 8.0);
        std::uniform_real_distribution<double> range(0.05, 2.8);
        std::uniform_real_distribution<double> phase(0.0, 10.0);
        for (std::size_t joint = 0; joint < kJoints; ++joint) {
            velocity_.at(joint) = velocity(random);
            range_.at(joint) = range(random);
            phase_s_.at(joint) = phase(random);
        }
    }
    [[nodiscard]] std::vector<JointLimits> limits() const {
        std::vector<JointLimits> limits;
        for (std::size_t joint = 0; joint < kJoints; ++joint)
            limits.push_back({-3.0, 3.0, velocity_.at(joint)});
        return limits;
    }
    /// Printed with as many decimals as the driver has.
    [[nodiscard]] std::vector<double> at(double seconds, double decimal) const {
        std::vector<double> position;
        for (std::size_t joint = 0; joint < kJoints; ++joint) {
            const double way = velocity_.at(joint) * (seconds + phase_s_.at(joint));
            const double turn = std::fmod(way, 4.0 * range_.at(joint));
            const double there = std::abs(turn - 2.0 * range_.at(joint)) - range_.at(joint);
            position.push_back(std::round(there / decimal) * decimal);
        }
        return position;
    }

  private:
    std::array<double, kJoints> velocity_{};
    std::array<double, kJoints> range_{};
    std::array<double, kJoints> phase_s_{};
};

struct Stream {
    double hz = 100.0;
    bool is_stamped = true;
    double burst_s = 0.0;   ///< what waits for a pipe or a socket comes together
    double jitter_s = 0.0;  ///< of the arrival beside that
    double decimal = 1e-6;
    bool has_gaps = false;
};

struct Sent {
    HostTime sampled;  ///< as the daemon dates it
    HostTime came;
    std::vector<double> position;
};

std::vector<Sent> send(const Arm& arm, const Stream& stream, std::mt19937_64& random) {
    std::uniform_real_distribution<double> part(0.0, 1.0);
    std::bernoulli_distribution begins_gap(stream.has_gaps ? 0.01 : 0.0);
    std::vector<Sent> sent;
    double came_s = 0.0;
    double quiet_until_s = 0.0;
    for (double taken_s = 1.0; taken_s < 9.0; taken_s += 1.0 / stream.hz) {
        if (begins_gap(random)) quiet_until_s = taken_s + 0.9 * part(random);
        if (taken_s < quiet_until_s) continue;
        double arrival_s = taken_s + 1e-4 + stream.jitter_s * part(random);
        if (stream.burst_s > 0.0) arrival_s = std::ceil(arrival_s / stream.burst_s) * stream.burst_s;
        came_s = std::max(came_s + 2e-5, arrival_s);  // one after the other
        const double dated_s = stream.is_stamped ? taken_s : came_s;
        sent.push_back({HostTime{std::llround(1e9 * dated_s)}, HostTime{std::llround(1e9 * came_s)},
                        arm.at(taken_s, stream.decimal)});
    }
    return sent;
}

std::string text(const Stream& stream, std::uint64_t seed) {
    return "seed " + std::to_string(seed) + ", " + std::to_string(stream.hz) + " Hz, " +
           (stream.is_stamped ? "stamped" : "dated by arrival") + ", bursts of " +
           std::to_string(stream.burst_s) + " s, " + std::to_string(stream.decimal) +
           (stream.has_gaps ? ", gaps" : "");
}

std::vector<Stream> streams() {
    std::vector<Stream> all;
    for (const double hz : {50.0, 60.0, 100.0, 125.0, 250.0, 500.0, 1000.0})
        for (const bool is_stamped : {true, false})
            for (const double burst_s : {0.0, 0.02})
                for (const double decimal : {1e-6, 1e-2})
                    for (const bool has_gaps : {false, true})
                        all.push_back(
                            {hz, is_stamped, burst_s, burst_s > 0.0 ? 0.0 : 0.015, decimal, has_gaps});
    return all;
}

constexpr std::uint64_t kSeeds = 10;

TEST(JointStreams, of_one_sound_driver_at_its_velocity_limit_never_jump) {
    std::size_t judged = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        for (const Stream& stream : streams()) {
            SCOPED_TRACE(text(stream, seed));
            std::mt19937_64 random(seed);
            const Arm arm(random);
            JointJump jump(arm.limits());
            LocalJoints thinned(5, kJoints, 100.0);
            for (const Sent& sample : send(arm, stream, random)) {
                if (!thinned.frames(sample.sampled, sample.position)) continue;
                ++judged;
                ASSERT_EQ(jump.judge(sample.sampled, sample.position), JointJump::SampleFit::fits)
                    << 1e-9 * static_cast<double>(sample.sampled.ns);
            }
        }
    }
    EXPECT_GT(judged, 100'000U) << "else this tests little";
}

// As a joint node on the bus has them: the numbers are those of what was sent, and some of it is lost.
TEST(JointStreams, of_one_sound_node_have_no_second_sender_and_lose_nothing_but_what_the_bus_lost) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        for (const Stream& stream : streams()) {
            SCOPED_TRACE(text(stream, seed));
            std::mt19937_64 random(seed);
            std::bernoulli_distribution is_lost(0.2);
            const Arm arm(random);
            LocalJoints thinned(5, kJoints, 100.0);
            JointSenderCheck check(100.0, true);
            JointSenderCheck::Ended ended;
            std::uint8_t sequence = 0;
            std::size_t arrived = 0;
            for (const Sent& sample : send(arm, stream, random)) {
                check.advance(sample.came, ended);
                if (!thinned.frames(sample.sampled, sample.position)) continue;
                sequence = static_cast<std::uint8_t>((sequence + 1U) % wire::kJointSequenceCount);
                if (is_lost(random)) continue;
                ++arrived;
                check.on_sample(sequence, {sample.sampled, {}}, sample.came, ended);
            }
            check.settle(ended);
            EXPECT_EQ(ended.size(), arrived);
            EXPECT_EQ(std::ranges::count_if(ended, [](const auto& one) { return !one.has_value(); }), 0);
            EXPECT_EQ(check.contradictions(), 0U);
        }
    }
}

}  // namespace
}  // namespace octoskin
