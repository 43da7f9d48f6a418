// A box before a range sensor of an arm that stands still, or moves slowly, comes and goes, 30 readings a
// second with the experiment's noise: how soon does the map say so, and of the voxels that every reading
// passes?
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/core/mapping/cone_finder.hpp"
#include "host/core/mapping/ray_model.hpp"
#include "host/core/pipeline/map_builder.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/camera/sensor_scene.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/shapes.hpp"

namespace octoskin {
namespace {

const std::filesystem::path kRigs = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/rigs";
const std::filesystem::path kScenario =
    std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/worlds/experiment.scenario.yaml";
constexpr std::int64_t kReadingPeriod_ns = 33'333'333;
constexpr int kReadings = 60;
constexpr std::int64_t kArmStarts_us = 1'000'000;
constexpr double kBoxAt_m = 0.5;
constexpr double kNever_s = 1e9;
constexpr double kGone_s = 1.0;  ///< from when a reading first passes a voxel to when that is free, at most
constexpr std::uint32_t kEachSensor = 4;  ///< one of so many is tried

struct Tested {
    const char* rig;
    const char* name;
    double arm_speed = 0.0;  ///< of the experiment's
    int readings = kReadings;
};

/// Counts, for each zone and voxel, how many readings passed it one after the other, while no zone's ended
/// there.
class PassesOfReadings final : public CommitListener {
  public:
    explicit PassesOfReadings(const MappingConfig& mapping) : rays_(mapping), cones_(mapping) {}
    void on_joints(const JointMeasurement&) override {}
    void on_depth(const DepthFrame&, const Evidence&) override {}
    void on_reading(const RangeMeasurement&, const Beam& beam, std::span<const VoxelUpdate>) override {
        beam_ = beam;
        std::set<VoxelKey> passed;
        if (beam.optics.is_cone()) {
            const auto voxels = cones_.find(beam).value();
            passed.insert(voxels->passed.begin(), voxels->passed.end());
            for (auto& [zone, passes] : of_zone_)
                for (const CapVoxel& voxel : voxels->cap) passes.erase(voxel.key);
        } else {
            for_each_term(rays_.find(beam).value()->terms, [&](const VoxelUpdate& term) {
                if (term.log_odds < 0.0F) passed.insert(term.key);
            });
        }
        std::map<VoxelKey, int> now;
        passes_ = &of_zone_[beam.source.zone];
        for (const VoxelKey key : passed) now[key] = (*passes_)[key] + 1;
        *passes_ = std::move(now);
    }
    void on_maps(std::span<const FedMap> maps) override {
        const FusedMap& map = *find_map(maps, MapFeed::both);
        for (const auto& [key, passes] : *passes_) {
            const bool is_occupied = map.occupancy(key) == Occupancy::occupied;
            if (is_occupied) {
                longest_ = std::max(longest_, passes);
                occupied_.insert(key);
            } else if (occupied_.erase(key) > 0) {
                ++freed_[passes];
            }
        }
    }
    [[nodiscard]] const std::optional<Beam>& beam() const { return beam_; }
    [[nodiscard]] int longest() const { return longest_; }
    [[nodiscard]] const std::map<int, std::size_t>& freed() const { return freed_; }

  private:
    RayModel rays_;
    ConeFinder cones_;
    std::optional<Beam> beam_;
    std::map<std::uint8_t, std::map<VoxelKey, int>> of_zone_;
    std::map<VoxelKey, int>* passes_ = nullptr;  ///< of the newest reading's zone
    std::set<VoxelKey> occupied_;
    std::map<int, std::size_t> freed_;
    int longest_ = 0;
};

class BoxBeforeRangeSensor : public testing::TestWithParam<Tested> {
  protected:
    BoxBeforeRangeSensor()
        : rig_(rig::read_rig(kRigs / GetParam().rig).value()),
          arm_(sim::Arm::read(rig_.urdf, rig_.base_link, rig_.joint_names()).value()),
          scenario_(sim::read_scenario(kScenario).value()),
          trajectory_(sim::Trajectory::circle(arm_, scenario_.motion, sim::SimTime{kArmStarts_us}).value()) {}

    /// The range sensors without noise of the mount in a world of one box, or of none near.
    [[nodiscard]] std::optional<double> range_m(const rig::Sensor& sensor, std::uint32_t noise_id,
                                                const sim::World& world, std::uint32_t index,
                                                const Roi& zone) const {
        const sim::Body no_robot({});
        const auto scene = sim::ranging_scene(
            {world, arm_, trajectory_, no_robot, rig_.links_ignored_by_sensors, scenario_.ranges, 1},
            {sensor.link, sensor.T_link_sensor, noise_id, sensor.cone});
        return scene(index, arm_time(index), zone).range_m;
    }

    /// Where on its way the arm is.
    [[nodiscard]] sim::SimTime arm_time(std::uint32_t index) const {
        return sim::SimTime{
            kArmStarts_us +
            std::llround(GetParam().arm_speed * static_cast<double>(index * kReadingPeriod_ns / 1000))};
    }

    static sim::World world_of(const Eigen::Vector3d& p_box) {
        TriangleMesh mesh = sim::box_mesh({0.3, 0.3, 0.3});
        sim::Solid solid{"box/body/cube", "box", mesh.vertices, mesh.triangles, true};
        for (Eigen::Vector3d& vertex : solid.vertices) vertex += p_box;
        return sim::World({solid});
    }

    rig::Rig rig_;
    sim::Arm arm_;
    sim::Scenario scenario_;
    sim::Trajectory trajectory_;
};

TEST_P(BoxBeforeRangeSensor, is_on_the_map_and_off_it_in_time) {
    const sim::World far_away = world_of({50.0, 0.0, 0.0});
    const MappingConfig mapping = [] {
        MappingConfig config = fast_mapping();
        config.removes_robot_from_ranges = false;
        config.no_return_clear_m = 2.0;  // behind the box there is nothing
        return config;
    }();
    std::map<int, std::size_t> freed;
    std::map<double, int> appeared;
    int longest = 0;
    const int readings = GetParam().readings;
    std::uint32_t noise_id = 0;
    for (const rig::Node& node : rig_.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i, ++noise_id) {
            if (noise_id % kEachSensor != 0) continue;
            for (const bool was_sure : {false, true}) {
                const rig::Sensor& sensor = node.sensors[i];
                const auto& zones = node.config.sensors[i].zones;
                const std::uint32_t zone_count = node.config.sensors[i].zone_count;
                HostSetup setup = make_host_setup(rig_).value();
                MapBuilder builder =
                    MapBuilder::build(setup.rig, std::move(setup.robot), mapping, {}, {MapFeed::both})
                        .value();
                PassesOfReadings passes(mapping);
                builder.set_listener(&passes);
                int reading = 0;
                const auto read = [&](const sim::World& world) {
                    const auto index = static_cast<std::uint32_t>(reading++);
                    const auto zone = static_cast<std::uint8_t>(index % zone_count);
                    const RangeMeasurement measurement{
                        {node.config.node_id, static_cast<std::uint8_t>(i), zone},
                        HostTime{1'100'000'000 + index * kReadingPeriod_ns},
                        range_m(sensor, noise_id, world, index, zones[zone]),
                        0.01};
                    const Eigen::VectorXd joints = trajectory_.at(arm_time(index));
                    for (const std::int64_t beside_ns : {-10'000'000, 10'000'000}) {
                        JointMeasurement sample{HostTime{measurement.captured.ns + beside_ns}, {}};
                        std::copy(joints.begin(), joints.end(), sample.position_rad.begin());
                        ASSERT_TRUE(builder.add(sample));
                    }
                    ASSERT_TRUE(builder.integrate(measurement));
                };
                read(far_away);
                if (!passes.beam()) continue;
                if (!was_sure) {
                    // So that the box comes before another zone each time.
                    const int more = static_cast<int>(noise_id / kEachSensor % zone_count);
                    for (int k = 0; k < readings + more; ++k) read(far_away);
                }
                const Eigen::Vector3d p_box =
                    passes.beam()->p_map_sensor + (kBoxAt_m + 0.15) * passes.beam()->direction_map;
                const sim::World with_box = world_of(p_box);
                if (was_sure) {  // by a camera, of all of the box
                    FusedMap sure(mapping.map);
                    const auto middle = sure.key_of(p_box).value();
                    for (int cell = 0; cell < 7 * 7 * 7; ++cell) {
                        const auto moved = [](std::uint16_t key, int by) {
                            return static_cast<std::uint16_t>(key + by - 3);
                        };
                        ASSERT_TRUE(sure.set_cube({{moved(middle.x, cell % 7), moved(middle.y, cell / 7 % 7),
                                                    moved(middle.z, cell / 49)},
                                                   0},
                                                  3.5F));
                    }
                    builder.begin_with(std::move(sure));
                }
                std::optional<int> first;
                for (int k = 0; k < readings; ++k) {
                    read(with_box);
                    bool has_occupied = false;
                    builder.map().for_each_known([&](VoxelKey, float log_odds) {
                        has_occupied =
                            has_occupied || builder.map().occupancy_of(log_odds) == Occupancy::occupied;
                    });
                    if (has_occupied && !first) first = k;
                }
                if (!was_sure) ++appeared[first ? *first / 30.0 : kNever_s];
                for (int k = 0; k < readings; ++k) read(far_away);
                for (const auto& [count, voxels] : passes.freed()) freed[count] += voxels;
                longest = std::max(longest, passes.longest());
            }
        }
    }
    const char* const name = GetParam().name;
    std::printf("%s: the box appears after, s:", name);
    for (const auto& [time_s, sensors] : appeared) std::printf(" %.2f: %d", time_s, sensors);
    std::printf("\n%s: voxels freed after so many readings that pass:", name);
    for (const auto& [count, voxels] : freed) std::printf(" %d: %zu", count, voxels);
    std::printf("\n");
    EXPECT_LE(appeared.rbegin()->first, 0.2 + 1e-9);
    if (GetParam().arm_speed > 0.0) return;  // the box that it comes upon no reading has passed
    EXPECT_FALSE(freed.empty());
    // A zone is read every so many readings.
    const double reading_s = static_cast<double>(rig_.nodes.front().config.sensors.front().zone_count) / 30.0;
    EXPECT_LE(longest * reading_s, kGone_s);
}

INSTANTIATE_TEST_SUITE_P(Rig, BoxBeforeRangeSensor,
                         testing::Values(Tested{"experiment.yaml", "ray"},
                                         Tested{"experiment_cone.yaml", "cone"},
                                         Tested{"experiment_cone.yaml", "cone_of_a_slow_arm", 0.3},
                                         Tested{"experiment_zones.yaml", "zones", 0.0, 120},
                                         Tested{"experiment_zones.yaml", "zones_of_a_slow_arm", 0.3, 60}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace octoskin
