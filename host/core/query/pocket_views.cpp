#include "host/core/query/pocket_views.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <random>

#include "host/core/voxels/ray_walk.hpp"

namespace octoskin {
namespace {

/// Origin and direction of a sensor's zone in its link's frame.
struct Eye {
    const HostSensor* sensor = nullptr;
    LinkId link = 0;
    Eigen::Vector3d p_link = Eigen::Vector3d::Zero();
    Eigen::Vector3d direction_link = Eigen::Vector3d::UnitZ();
};

std::vector<Eye> eyes_of(const HostRig& rig, const RobotModel& robot) {
    std::vector<Eye> eyes;
    for (const HostNode& node : rig.nodes) {
        for (const HostSensor& sensor : node.sensors) {
            const auto link = robot.find_link(sensor.link);
            if (!link) continue;
            for (const HostZone& zone : sensor.zones)
                eyes.push_back({&sensor, *link, sensor.T_link_sensor.translation(),
                                sensor.T_link_sensor.linear() * zone.direction_sensor});
        }
    }
    return eyes;
}

struct Sight {
    std::size_t pocket = 0;
    double range_m = 0.0;
};

/// Finds the first voxel that is not free, if it is in the border of a pocket.
std::optional<Sight> look(const FusedMap& map, const UnknownPockets& pockets, const Eigen::Vector3d& origin,
                          const Eigen::Vector3d& direction, double range_max_m) {
    const Eigen::Vector3d end = origin + range_max_m * direction;
    const auto ray = plan_ray(map.lattice(), origin.cast<float>(), end.cast<float>());
    if (!ray) return std::nullopt;
    std::optional<VoxelKey> first;
    walk_ray_keys(*ray, [&](VoxelKey key) {
        if (!first && map.occupancy(key) != Occupancy::free) first = key;
    });
    if (!first) return std::nullopt;
    const auto pocket = pockets.border_of(*first);
    if (!pocket) return std::nullopt;
    return Sight{*pocket, (map.centre_of(*first) - origin).norm()};
}

/// Generates the postures to be tried.
class Postures {
  public:
    Postures(std::span<const JointLimits> limits, std::span<const double> from,
             const PocketViewConfig& config)
        : limits_(limits), from_(from), spread_(config.near_spread), random_(config.seed) {}

    void next(std::vector<double>& position) {
        const bool is_near = (count_++ % 2) == 0;
        for (std::size_t i = 0; i < position.size(); ++i) {
            // A continuous joint has no limits.
            const double lowest = std::isfinite(limits_[i].min) ? limits_[i].min : -std::numbers::pi;
            const double highest = std::isfinite(limits_[i].max) ? limits_[i].max : std::numbers::pi;
            const double wanted = is_near ? from_[i] + spread_ * normal_(random_)
                                          : lowest + (highest - lowest) * unit_(random_);
            position[i] = std::clamp(wanted, limits_[i].min, limits_[i].max);
        }
    }

  private:
    std::span<const JointLimits> limits_;
    std::span<const double> from_;
    double spread_;
    std::mt19937 random_;
    std::normal_distribution<double> normal_;
    std::uniform_real_distribution<double> unit_{0.0, 1.0};
    std::size_t count_ = 0;
};

PostureState state_of(const RobotQuery& robot, const FusedMap& map, std::span<const double> position,
                      const FreeDemand& demand) {
    const auto capsules = robot.pose(position);
    if (!capsules) return PostureState::occupied;
    const auto answer = worst_of(robot, map, *capsules, demand);
    return answer ? answer->state : PostureState::occupied;
}

bool is_better(PostureState state, double change, const std::optional<PocketView>& than) {
    if (!than || state != than->state) return !than || state < than->state;
    return change < than->joint_change_max;
}

double largest_change(std::span<const double> from, std::span<const double> to) {
    double largest = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) largest = std::max(largest, std::abs(to[i] - from[i]));
    return largest;
}

}  // namespace

std::vector<std::optional<PocketView>> find_views(const HostRig& rig, const RobotQuery& robot,
                                                  const FusedMap& map, const UnknownPockets& pockets,
                                                  std::span<const double> from,
                                                  const PocketViewConfig& config,
                                                  const std::function<bool()>& is_ending) {
    assert(from.size() == robot.robot().joint_count());
    const std::vector<Eye> eyes = eyes_of(rig, robot.robot());
    std::vector<std::optional<PocketView>> views(std::min(config.pockets, pockets.pockets().size()));
    Postures postures(robot.robot().limits(), from, config);
    std::vector<double> position(from.begin(), from.end());
    std::vector<Eigen::Isometry3d> T_base_link(robot.robot().link_count());
    for (std::size_t tried = 0; tried < config.postures && !views.empty() && !is_ending(); ++tried) {
        if (tried > 0) postures.next(position);  // the first try is the present posture
        const double change = largest_change(from, position);
        robot.robot().forward(position, T_base_link);
        std::optional<PostureState> state;  // computed when a pocket is in view
        for (const Eye& eye : eyes) {
            const Eigen::Isometry3d T_map_link = rig.T_map_base * T_base_link[eye.link];
            const auto sight = look(map, pockets, T_map_link * eye.p_link,
                                    T_map_link.linear() * eye.direction_link, rig.range_limits.max_m);
            if (!sight || sight->pocket >= views.size()) continue;
            auto& view = views[sight->pocket];
            if (!is_better(state.value_or(PostureState::free), change, view)) continue;
            if (!state) state = state_of(robot, map, position, config.demand);
            if (*state == PostureState::occupied) break;
            if (is_better(*state, change, view))
                view = PocketView{position, *state, eye.sensor->name, sight->range_m, change};
        }
    }
    return views;
}

}  // namespace octoskin
