// Things come, go and are moved before the simulated camera (hw/worlds/moving.*), with the experiment's
// noise: how soon does the map say so? Times are those at which images were taken, at 10 Hz: working one out
// comes on top.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/core/pipeline/map_builder.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/camera/depth_camera.hpp"
#include "hw/sim/scenario/motion.hpp"
#include "hw/sim/scenario/scenario.hpp"

namespace octoskin {
namespace {

const std::filesystem::path kHwFolder = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw";
constexpr double kFramePeriod_s = 0.1;
constexpr int kFramesInAll = 110;
constexpr int kBlindFrom = 60;  ///< frames that nobody takes
constexpr int kBlindUntil = 80;

HostTime host_time(int frame) {
    return {1'000'000'000 + std::int64_t{frame} * 100'000'000};
}

/// Of every voxel that was occupied: how many images had all their rays pass it, one after the other, until
/// it was free.
class PassesUntilFree final : public CommitListener {
  public:
    void on_joints(const JointMeasurement&) override {}
    void on_reading(const RangeMeasurement&, const Beam&, std::span<const VoxelUpdate>) override {}
    void on_depth(const DepthFrame&, const Evidence& terms) override {
        for (auto& [key, passes] : passes_) passes = term_of(terms, key) == terms.miss ? passes + 1 : 0;
    }
    void on_maps(std::span<const FedMap> maps) override {
        const FusedMap& map = *find_map(maps, MapFeed::both);
        for (auto entry = passes_.begin(); entry != passes_.end();) {
            longest_ = std::max(longest_, entry->second);
            if (map.occupancy(entry->first) == Occupancy::occupied) {
                ++entry;
                continue;
            }
            if (entry->second > 0) ++freed_[entry->second];
            entry = passes_.erase(entry);
        }
        map.for_each_known([&](VoxelKey key, float log_odds) {
            if (map.occupancy_of(log_odds) == Occupancy::occupied) passes_.try_emplace(key, 0);
        });
    }
    [[nodiscard]] const std::map<int, std::size_t>& freed() const { return freed_; }
    [[nodiscard]] int longest() const { return longest_; }

  private:
    std::map<VoxelKey, int> passes_;
    std::map<int, std::size_t> freed_;
    int longest_ = 0;
};

/// Where one thing is, and how many occupied voxels the map had there after each frame.
struct Watched {
    std::string name;
    Eigen::AlignedBox3d box;
    std::vector<std::size_t> occupied = {};

    /// Seconds from a frame to the first from which on there are at least so many; none: never.
    [[nodiscard]] std::optional<double> first_s(int from, std::size_t at_least) const {
        for (int frame = from; frame < kFramesInAll; ++frame)
            if (occupied[static_cast<std::size_t>(frame)] >= at_least) return kFramePeriod_s * (frame - from);
        return std::nullopt;
    }
    [[nodiscard]] std::optional<double> gone_s(int from) const {
        for (int frame = from; frame < kFramesInAll; ++frame)
            if (occupied[static_cast<std::size_t>(frame)] == 0) return kFramePeriod_s * (frame - from);
        return std::nullopt;
    }
    [[nodiscard]] std::size_t at(int frame) const { return occupied[static_cast<std::size_t>(frame)]; }
};

class MovingWorldBeforeCamera : public testing::TestWithParam<std::pair<const char*, MappingConfig>> {
  protected:
    MovingWorldBeforeCamera()
        : rig_(rig::read_rig(kHwFolder / "rigs/experiment.yaml").value()),
          scenario_(sim::read_scenario(kHwFolder / "worlds/experiment.scenario.yaml").value()),
          still_(sim::World::read(kHwFolder / "worlds/moving.sdf").value()),
          moving_(still_.solids(),
                  sim::read_motion(kHwFolder / "worlds/moving.motion.yaml", still_.solids()).value()) {}

    /// A model's box where the SDF has it, but for its lowest 4 cm: the floor's.
    [[nodiscard]] Eigen::AlignedBox3d box_of(const std::string& model) const {
        Eigen::AlignedBox3d box;
        for (const sim::Solid& solid : still_.solids())
            if (solid.model == model)
                for (const Eigen::Vector3d& vertex : solid.vertices) box.extend(vertex);
        box.min() -= Eigen::Vector3d::Constant(0.02);
        box.max() += Eigen::Vector3d::Constant(0.02);
        box.min().z() = std::max(box.min().z(), 0.04);
        return box;
    }

    void look(std::uint64_t seed, const MappingConfig& shipped) {
        MappingConfig mapping = shipped;
        mapping.removes_robot_from_depth = false;
        HostSetup setup = make_host_setup(rig_).value();
        MapBuilder builder =
            MapBuilder::build(setup.rig, std::move(setup.robot), mapping, {}, {MapFeed::both}).value();
        builder.set_listener(&passes_);
        for (int frame = 0; frame < kFramesInAll; ++frame) {
            const double time_s = kFramePeriod_s * frame;
            if (frame < kBlindFrom || frame >= kBlindUntil) {
                const sim::DepthCamera camera(moving_.at(time_s), rig_.cameras.front(), scenario_.depth_noise,
                                              seed);
                ASSERT_TRUE(builder.integrate(
                    DepthFrame{host_time(frame), rig_.cameras.front().width, rig_.cameras.front().height,
                               camera.render({}, static_cast<std::uint32_t>(frame))}));
            }
            count(builder.map());
        }
    }

    void count(const FusedMap& map) {
        for (Watched& watched : watched_) watched.occupied.push_back(0);
        map.for_each_known([&](VoxelKey key, float log_odds) {
            if (map.occupancy_of(log_odds) != Occupancy::occupied) return;
            for (Watched& watched : watched_)
                if (watched.box.contains(map.centre_of(key))) ++watched.occupied.back();
        });
    }

    rig::Rig rig_;
    sim::Scenario scenario_;
    sim::World still_;
    sim::MovingWorld moving_;
    PassesUntilFree passes_;
    std::vector<Watched> watched_{{"ball", box_of("ball")},
                                  {"box", box_of("box")},
                                  {"cart", box_of("cart")},
                                  {"parcel", box_of("parcel")},
                                  {"guest", box_of("guest")}};
};

TEST_P(MovingWorldBeforeCamera, is_on_the_map_in_time) {
    const std::uint64_t seeds = GetParam().second.depth_update == DepthUpdate::fast ? 2 : 1;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        for (Watched& watched : watched_) watched.occupied.clear();
        look(seed, GetParam().second);
        const auto tell = [&](const char* what, const std::optional<double>& time_s) {
            std::printf("%s, seed %d: %s after %.1f s\n", GetParam().first, static_cast<int>(seed), what,
                        time_s.value_or(-1.0));
            return time_s.value_or(1e9);
        };
        constexpr double kRounding = 1e-9;
        // First frames in which they are there, or no longer.
        const Watched& ball = watched_[0];
        const Watched& guest = watched_[4];
        const std::size_t of_ball = ball.at(25);
        const std::size_t of_guest = guest.at(100);
        EXPECT_GT(of_ball, 10U);
        EXPECT_GT(of_guest, 10U);
        EXPECT_GT(watched_[1].at(30), 10U) << "the box, before it is carried off";
        EXPECT_GT(watched_[2].at(39), 10U) << "the cart, before it is pushed";
        EXPECT_GT(watched_[3].at(59), 10U) << "the parcel, before nobody looks";
        EXPECT_LE(tell("ball appears", ball.first_s(11, 1)), 0.2 + kRounding);
        EXPECT_LE(tell("half of the ball", ball.first_s(11, of_ball / 2)), 0.2 + kRounding);
        (void)tell("nine tenths of the ball", ball.first_s(11, of_ball * 9 / 10));
        EXPECT_LE(tell("guest appears", guest.first_s(80, 1)), 0.2 + kRounding);
        EXPECT_LE(tell("half of the guest", guest.first_s(80, of_guest / 2)), 0.2 + kRounding);
        (void)tell("nine tenths of the guest", guest.first_s(80, of_guest * 9 / 10));
        EXPECT_LE(tell("ball gone", ball.gone_s(31)), 0.5 + kRounding);
        EXPECT_LE(tell("box gone", watched_[1].gone_s(31)), 0.5 + kRounding);
        EXPECT_LE(tell("parcel gone", watched_[3].gone_s(80)), 0.5 + kRounding);
        EXPECT_LE(tell("cart gone from where it was", watched_[2].gone_s(47)), 0.5 + kRounding);
    }
    std::printf("%s: voxels freed after so many images whose rays all pass:", GetParam().first);
    for (const auto& [passes, voxels] : passes_.freed()) std::printf(" %d: %zu", passes, voxels);
    std::printf("\n");
    EXPECT_LE(passes_.longest(), 5) << "5 images at 10 Hz take 0.4 s from the first on";
}

INSTANTIATE_TEST_SUITE_P(Default, MovingWorldBeforeCamera,
                         testing::Values(std::pair("fast", fast_mapping()),
                                         std::pair("robust", robust_mapping())),
                         [](const auto& tested) { return std::string(tested.param.first); });

}  // namespace
}  // namespace octoskin
