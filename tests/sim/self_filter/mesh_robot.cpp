#include "tests/sim/self_filter/mesh_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "host/core/pipeline/map_builder.hpp"
#include "host/core/self_filter/robot_filter.hpp"
#include "host/io/robot/robot_fit.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/camera/depth_camera.hpp"

namespace octoskin {
namespace {

constexpr double kSpeed_mps = 1.0;
constexpr double kFrame_s = 0.1;
constexpr std::int64_t kStart_ns = 1'000'000'000;
constexpr std::uint32_t kFramesBefore = 10;

template <class T, class E>
T needed(Result<T, E> result) {
    EXPECT_TRUE(result.has_value());
    return std::move(result).value();
}

rig::Rig rig_of(const RobotText& robot, std::string urdf) {
    rig::Rig rig;
    rig.name = "mesh_robot";
    rig.urdf = FilePlace::held(std::move(urdf), robot.file);
    rig.base_link = robot.shapes.base_link;
    rig::JointSource& source = rig.joint_sources.emplace_back();
    for (const rig::ShapedJoint& joint : robot.shapes.joints) source.joints.push_back(joint.name);
    rig.cameras = needed(rig::read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml")).cameras;
    return rig;
}

sim::Body true_body(const rig::Rig& rig, const RobotSurfaces& surfaces) {
    rig::Rig rest = rig;
    rest.urdf = FilePlace::held(surfaces.urdf, rig.urdf);
    std::vector<sim::LinkMesh> meshes;
    for (const LinkSurface& surface : surfaces.meshes)
        meshes.push_back({surface.link, {surface.mesh.vertices, surface.mesh.triangles}});
    return sim::Body(needed(rig::real_body(rest)), meshes);
}

/// Of a point to a triangle.
double distance_to(const Triangle& t, const Eigen::Vector3d& p) {
    const Eigen::Vector3d ab = t[1] - t[0], ac = t[2] - t[0];
    const Eigen::Vector3d normal = ab.cross(ac);
    double nearest = std::numeric_limits<double>::infinity();
    bool is_over = normal.squaredNorm() > 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3d edge = t[(i + 1) % 3] - t[i], from = p - t[i];
        const double length2 = edge.squaredNorm();
        const double part = length2 > 0.0 ? std::clamp(from.dot(edge) / length2, 0.0, 1.0) : 0.0;
        nearest = std::min(nearest, (from - part * edge).norm());
        is_over = is_over && normal.cross(edge).dot(from) >= 0.0;
    }
    return is_over ? std::abs(normal.normalized().dot(p - t[0])) : nearest;
}

}  // namespace

MeshRobot::MeshRobot(const RobotText& robot, const MeshSearch& search, const sim::World& world)
    : rig_(rig_of(robot, needed(fit_robot(robot, search)).urdf)),
      surfaces_(needed(read_surfaces(robot, search)).meshes),
      arm_(needed(sim::Arm::read(rig_.urdf, rig_.base_link, rig_.joint_names()))),
      truth_(true_body(rig_, needed(read_surfaces(robot, search)))),
      setup_(needed(make_host_setup(rig_))),
      capsules_(needed(RobotBody::build(setup_.rig.body, setup_.robot))),
      world_(world) {
    const auto count = static_cast<Eigen::Index>(robot.shapes.joints.size());
    middle_.resize(count);
    swing_.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const rig::ShapedJoint& joint = robot.shapes.joints[static_cast<std::size_t>(i)];
        const double lower = std::max(joint.lower.value_or(-1.5), -1.5);
        const double upper = std::min(joint.upper.value_or(1.5), 1.5);
        middle_[i] = 0.5 * (lower + upper);
        swing_[i] = 0.4 * (upper - lower);
    }
    double fastest = 0.0;
    for (int i = 0; i < 50; ++i) fastest = std::max(fastest, fastest_mps(0.1 * i));
    rate_ = kSpeed_mps / fastest;
}

Eigen::VectorXd MeshRobot::joints_at(double time_s) const {
    Eigen::VectorXd joints = middle_;
    for (Eigen::Index i = 0; i < joints.size(); ++i) {
        // Frequencies that do not repeat together.
        const double phase = rate_ * time_s * (1.0 + 0.37 * static_cast<double>(i)) + static_cast<double>(i);
        joints[i] += swing_[i] * std::sin(phase);
    }
    return joints;
}

double MeshRobot::fastest_mps(double time_s) const {
    constexpr double kStep_s = 1e-3;
    const auto before = arm_.forward(joints_at(time_s)), after = arm_.forward(joints_at(time_s + kStep_s));
    double fastest = 0.0;
    for (const LinkSurface& surface : surfaces_)
        for (const Eigen::Vector3d& vertex : surface.mesh.vertices)
            fastest = std::max(fastest,
                               (after.at(surface.link) * vertex - before.at(surface.link) * vertex).norm());
    return fastest / kStep_s;
}

std::vector<PosedCapsule> MeshRobot::capsules_at(const Eigen::VectorXd& joints) const {
    std::vector<Eigen::Isometry3d> T_base_link(setup_.robot.link_count());
    setup_.robot.forward(std::span(joints.data(), static_cast<std::size_t>(joints.size())), T_base_link);
    std::vector<PosedCapsule> capsules;
    capsules_.pose(T_base_link, capsules);
    const Eigen::Isometry3d T_camera_base = rig_.cameras.front().T_link_camera.inverse();
    for (PosedCapsule& capsule : capsules) {
        capsule.p_a = T_camera_base * capsule.p_a;
        capsule.p_b = T_camera_base * capsule.p_b;
    }
    return capsules;
}

double MeshRobot::distance_to_mesh(const sim::PosedBody& body, const Eigen::Vector3d& p_base,
                                   double most_m) const {
    double nearest = most_m;
    for (std::size_t i = 0; i < body.meshes.size(); ++i) {
        const sim::PosedMesh& posed = body.meshes[i];
        const Eigen::Vector3d p_link = posed.T_frame_link.inverse() * p_base;
        if ((p_link - posed.mesh->p_link_middle()).norm() > posed.mesh->radius_m() + nearest) continue;
        const SurfaceMesh& mesh = surfaces_[i].mesh;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle corners = mesh.corners(t);
            const Eigen::Array3d low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]).array() - nearest;
            const Eigen::Array3d high =
                corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]).array() + nearest;
            if ((p_link.array() < low).any() || (p_link.array() > high).any()) continue;
            nearest = std::min(nearest, distance_to(corners, p_link));
        }
    }
    for (const sim::BodyCapsule& capsule : body.capsules) {
        const PosedCapsule posed{capsule.p_base_a, capsule.p_base_b, capsule.radius_m, 0};
        nearest = std::min(nearest, std::max(0.0, distance_to_surface(posed, p_base)));
    }
    return nearest;
}

MeshRobot::Pixels MeshRobot::filter(int frames, double late_s) const {
    const rig::Camera& camera = rig_.cameras.front();
    const sim::DepthCamera seen(world_, camera, {}, 0);
    const PixelRays rays(host_camera(camera).intrinsics);
    const std::vector<std::uint16_t> scene = seen.render({}, 0);
    Pixels pixels;
    for (int frame = 0; frame < frames; ++frame) {
        const double time_s = kFrame_s * frame;
        const sim::PosedBody body = truth_.at(arm_.forward(joints_at(time_s)));
        const std::vector<std::uint16_t> with = seen.render(body, 0);
        DepthImage image{camera.width, camera.height, std::vector<float>(with.size())};
        std::ranges::transform(with, image.depth_m.begin(), [](std::uint16_t mm) {
            return mm == 0 ? std::numeric_limits<float>::quiet_NaN() : 1e-3F * static_cast<float>(mm);
        });
        (void)remove_robot(image, rays, capsules_at(joints_at(time_s - late_s)), rig_.depth_self_margin_m);
        for (std::size_t i = 0; i < with.size(); ++i) {
            if (with[i] == 0) continue;
            const bool is_removed = std::isnan(image.depth_m[i]);
            if (with[i] != scene[i]) {
                ++pixels.of_robot;
                pixels.robot_left += is_removed ? 0U : 1U;
                continue;
            }
            ++pixels.of_scene;
            if (!is_removed) continue;
            ++pixels.scene_removed;
            const auto u = static_cast<std::uint32_t>(i % camera.width);
            const auto v = static_cast<std::uint32_t>(i / camera.width);
            const RaySlope ray = rays.at(u, v);
            const Eigen::Vector3d p_base =
                camera.T_link_camera * (1e-3 * with[i] * Eigen::Vector3d(ray.x, ray.y, 1.0));
            const double distance_m = distance_to_mesh(body, p_base, 0.3);
            pixels.farthest_removed_m = std::max(pixels.farthest_removed_m, distance_m);
            pixels.beyond_margin += distance_m > rig_.depth_self_margin_m ? 1U : 0U;
        }
    }
    return pixels;
}

std::size_t MeshRobot::frames_occupied(int frames, double late_s, const MappingConfig& mapping) const {
    const sim::DepthCamera seen(world_, rig_.cameras.front(), sim::gaussian_noise(0.03), 1);
    const auto builder = [&](bool removes_robot) {
        MappingConfig config = mapping;
        config.removes_robot_from_depth = removes_robot;
        HostSetup setup = needed(make_host_setup(rig_));
        auto made = MapBuilder::build(setup.rig, std::move(setup.robot), config, {}, {MapFeed::both});
        MapBuilder built = std::move(made).value();
        for (int at_ms = -2000; at_ms < 100 * (frames + 2); at_ms += 10) {
            const double time_s = 1e-3 * at_ms;
            const Eigen::VectorXd joints = joints_at(time_s);
            JointMeasurement sample{HostTime{kStart_ns + std::llround(1e9 * (time_s + late_s))}, {}};
            std::copy(joints.begin(), joints.end(), sample.position_rad.begin());
            EXPECT_TRUE(built.add(sample));
        }
        return built;
    };
    MapBuilder alone = builder(false), both = builder(true);
    const auto occupied = [](const MapBuilder& built) {
        std::map<VoxelKey, std::size_t> keys;
        built.map().for_each_known([&](VoxelKey key, float log_odds) {
            if (built.map().occupancy_of(log_odds) == Occupancy::occupied) keys[key] = 0;
        });
        return keys;
    };
    const VoxelLattice lattice(mapping.map.resolution_m);
    std::map<VoxelKey, std::size_t> before;
    std::size_t most = 0;
    std::map<VoxelKey, std::size_t> ever_of_world;
    for (std::uint32_t frame = 0; frame < kFramesBefore + static_cast<std::uint32_t>(frames); ++frame) {
        const double time_s = kFrame_s * (static_cast<double>(frame) - kFramesBefore);
        const auto integrate = [&](MapBuilder& built, const sim::PosedBody& body) {
            ASSERT_TRUE(built.integrate(DepthFrame{HostTime{kStart_ns + std::llround(1e9 * time_s)},
                                                   rig_.cameras.front().width, rig_.cameras.front().height,
                                                   seen.render(body, frame)}));
        };
        const bool has_robot = frame >= kFramesBefore;
        integrate(alone, {});
        integrate(both, has_robot ? truth_.at(arm_.forward(joints_at(time_s))) : sim::PosedBody());
        for (const auto& [key, zero] : occupied(alone)) ever_of_world[key] = zero;
        if (!has_robot) continue;
        std::map<VoxelKey, std::size_t> now;
        for (const auto& [key, zero] : occupied(both)) {
            bool is_of_world = false;
            for (int i = 0; i < 27 && !is_of_world; ++i) {
                const auto moved = [](std::uint16_t k, int by) { return static_cast<std::uint16_t>(k + by); };
                is_of_world = ever_of_world.contains(
                    {moved(key.x, i % 3 - 1), moved(key.y, i / 3 % 3 - 1), moved(key.z, i / 9 - 1)});
            }
            if (is_of_world) continue;
            const auto last = before.find(key);
            now[key] = 1 + (last == before.end() ? 0 : last->second);
            most = std::max(most, now[key]);
        }
        before = std::move(now);
    }
    return most;
}

}  // namespace octoskin
