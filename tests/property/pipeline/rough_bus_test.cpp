// A bus that loses, repeats, delays and damages frames, and one on which strangers talk: nothing is placed
// where it was not taken, and every input is accounted for. A failure prints its seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "common/wire/codec.hpp"
#include "tests/support/wire/frame_oracle.hpp"
#include "tests/unit/host/core/pipeline/turning_scene.hpp"

namespace octoskin::test {
namespace {

class Dice {
  public:
    explicit Dice(std::uint32_t seed) : random_(seed) {}
    [[nodiscard]] std::uint64_t up_to(std::uint64_t most) {
        return std::uniform_int_distribution<std::uint64_t>(0, most)(random_);
    }
    [[nodiscard]] bool chance(double probability) {
        return std::bernoulli_distribution(probability)(random_);
    }

  private:
    std::mt19937 random_;
};

std::vector<StampedFrame> by_arrival(std::vector<StampedFrame> frames) {
    std::ranges::stable_sort(frames, {}, &StampedFrame::stamp);
    return frames;
}

TEST(RoughBus, loses_single_frames_and_bursts) {
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Dice dice(seed);
        const Scene scene = turning_scene();
        const double loss = 0.0125 * (1 + seed);  // up to half of all
        std::vector<StampedFrame> left;
        std::uint64_t burst = 0;
        for (const StampedFrame& entry : scene.bus.frames()) {
            burst = burst > 0 ? burst - 1 : (dice.chance(0.002) ? dice.up_to(60) : 0);
            if (burst == 0 && !dice.chance(loss)) {
                left.push_back(entry);
            }
        }
        expect_hits_where_shots_ended(play(scene, left), 0);
    }
}

TEST(RoughBus, repeats_and_delays_frames_and_flips_up_to_three_of_their_bits) {
    std::uint64_t used = 0;
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Dice dice(seed);
        const Scene scene = turning_scene();
        std::vector<StampedFrame> rough;
        for (StampedFrame entry : scene.bus.frames()) {
            const bool is_sync = entry.frame.can_id == wire::can_id(wire::FrameType::sync, wire::kHostId);
            if (dice.chance(0.05) && !is_sync) {
                entry.stamp.ns += static_cast<std::int64_t>(dice.up_to(70'000'000));
            }
            for (std::uint64_t flips = dice.chance(0.05) ? 1 + dice.up_to(2) : 0; flips > 0; --flips) {
                const std::size_t bit = dice.up_to(8U * entry.frame.payload_len - 1U);
                entry.frame.data.at(bit / 8) ^= static_cast<std::uint8_t>(1U << (bit % 8));
            }
            rough.push_back(entry);
            if (dice.chance(0.05) && !is_sync) {
                entry.stamp.ns += static_cast<std::int64_t>(dice.up_to(5'000'000));
                rough.push_back(entry);
            }
        }
        const Pipeline pipeline = play(scene, by_arrival(rough));
        expect_hits_where_shots_ended(pipeline, 0);
        used += pipeline.inputs().readings.used();
    }
    EXPECT_GT(used, 40U * 40U) << "of 149 each: else this tests little";
}

/// Random bytes with a valid checksum, of a type and a node that exist.
wire::CanFrame stranger(Dice& dice) {
    const wire::FrameSpec& spec = wire::kFrameSpecs.at(dice.up_to(wire::kFrameSpecs.size() - 1));
    const auto node =
        static_cast<wire::NodeId>(spec.party == wire::Party::from_host ? 0 : 1 + dice.up_to(10));
    const std::uint32_t can_id = wire::can_id(spec.type, node);
    Payload payload(spec.type == wire::FrameType::range_fd
                        ? wire::range_fd_length(static_cast<std::uint8_t>(1 + dice.up_to(3)))
                        : spec.payload_len);
    for (std::uint8_t& byte : payload) {
        byte = static_cast<std::uint8_t>(dice.up_to(255));
    }
    set_bits(payload, 0, 3, wire::kProtocolVersion);
    sign(can_id, payload, checksum_len_of(can_id));
    return frame_of(can_id, spec.is_fd, payload);
}

TEST(RoughBus, carries_frames_of_a_stranger_who_knows_the_checksums_without_losing_count) {
    std::uint64_t decoded = 0;
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Dice dice(seed);
        const Scene scene = turning_scene();
        std::vector<StampedFrame> crowded;
        for (const StampedFrame& entry : scene.bus.frames()) {
            crowded.push_back(entry);
            while (dice.chance(0.5)) {
                crowded.push_back({entry.stamp, stranger(dice)});
                decoded += wire::decode(crowded.back().frame) ? 1U : 0U;
            }
        }
        const Pipeline pipeline = play(scene, crowded);
        EXPECT_EQ(pipeline.inputs().frames.in(), crowded.size());
    }
    EXPECT_GT(decoded, 10'000U);
}

TEST(RoughBus, carries_noise_without_losing_count) {
    Dice dice(1);
    const Scene scene = turning_scene();
    Pipeline pipeline = make_pipeline(scene);
    for (int i = 0; i < 50'000; ++i) {
        wire::CanFrame frame;
        frame.can_id = static_cast<std::uint32_t>(dice.up_to(0x7FF));
        frame.is_extended = dice.chance(0.05);
        frame.is_remote = dice.chance(0.05);
        frame.is_error = dice.chance(0.05);
        frame.is_fd = dice.chance(0.3);
        frame.payload_len = static_cast<std::uint8_t>(dice.up_to(frame.is_fd ? 64 : 8));
        for (std::uint8_t& byte : frame.data) {
            byte = static_cast<std::uint8_t>(dice.up_to(255));
        }
        pipeline.on_can(frame, {static_cast<std::int64_t>(dice.up_to(1'000'000'000'000))});
        ASSERT_TRUE(i % 1000 != 0 || pipeline.is_balanced());
    }
    pipeline.finish();
    EXPECT_TRUE(pipeline.is_balanced());
    EXPECT_EQ(pipeline.map().known_voxels(), 0U);
}

}  // namespace
}  // namespace octoskin::test
