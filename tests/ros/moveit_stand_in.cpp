// Applies planning scenes as MoveIt 2 does and answers which postures collide: the README.md of this folder.
#include <array>
#include <stdexcept>

#include "tests/ros/arguments.hpp"
#include "tests/ros/octree_collisions.hpp"
#include "tests/ros/output.hpp"

namespace octoskin::ros {
namespace {

constexpr const char* kUsage =
    R"(usage: moveit_stand_in (--root FRAME | --frames FILE) [--postures FILE] SCENE.cdr...

  --root FRAME       the only frame that MoveIt knows, its root
  --frames FILE      {"base_link": [x, y, z, qx, qy, qz, qw], ...}: the pose of each known frame in the root frame
  --postures FILE    a list of postures, each a list of bodies in the root frame, metres:
                     {"a": [x, y, z], "b": [x, y, z], "radius": r}, a capsule; without "b" a sphere

Applies the samples of moveit_msgs/PlanningScene in their order, then prints a line for each posture. Exit code 1 if a
sample was refused.
)";

Json read_json_file(const std::string& path) {
    const Bytes bytes = read_file(path);
    return Json::parse(bytes.begin(), bytes.end());
}

Frames frames_of(const Arguments& arguments) {
    Frames frames;
    if (arguments.has("--root")) {
        frames[arguments.text("--root", "")] = Eigen::Isometry3d::Identity();
    }
    if (arguments.has("--frames")) {
        const Json poses = read_json_file(arguments.text("--frames", ""));
        for (const auto& [name, pose] : poses.items()) {
            const auto v = pose.get<std::array<double, 7>>();
            frames[name] = Eigen::Translation3d(v[0], v[1], v[2]) *
                           Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized();
        }
    }
    if (frames.empty()) {
        throw std::invalid_argument("no frame: --root or --frames (--help)");
    }
    return frames;
}

Eigen::Vector3d point_of(const Json& json) {
    const auto values = json.get<std::array<double, 3>>();
    return {values[0], values[1], values[2]};
}

Body body_of(const Json& json) {
    const Eigen::Vector3d a = point_of(json.at("a"));
    return {a, json.contains("b") ? point_of(json["b"]) : a, json.at("radius").get<double>()};
}

std::string name_of(PlanningScene::Change change) {
    switch (change) {
        case PlanningScene::Change::none:
            return "unchanged";
        case PlanningScene::Change::replaced:
            return "replaced";
        case PlanningScene::Change::cleared:
            return "cleared";
    }
    return "";
}

/// Voxels of the finest level that leaves cover.
Json sizes_of(const PosedOctree& octree) {
    std::size_t occupied = 0;
    std::size_t free = 0;
    for (auto leaf = octree.tree->begin_leafs(); leaf != octree.tree->end_leafs(); ++leaf) {
        const std::size_t edge = std::size_t{1} << (octree.tree->getTreeDepth() - leaf.getDepth());
        (octree.tree->isNodeOccupied(*leaf) ? occupied : free) += edge * edge * edge;
    }
    return {{"resolution", octree.tree->getResolution()},
            {"nodes", octree.tree->size()},
            {"voxels_occupied", occupied},
            {"voxels_free", free}};
}

/// Returns whether it was not refused.
bool apply(PlanningScene& scene, const std::string& path) {
    PlanningScene::Outcome outcome;
    try {
        outcome = scene.apply(read_file(path));
    } catch (const std::exception& error) {
        outcome.errors.push_back(std::string("no message: ") + error.what());
    }
    print({{"event", "scene"},
           {"file", path},
           {"octomap", name_of(outcome.change)},
           {"tree", scene.octree() == nullptr ? Json() : sizes_of(*scene.octree())},
           {"also_changes", outcome.also_changes},
           {"errors", outcome.errors}});
    return outcome.errors.empty();
}

void print_collisions(const PlanningScene& scene, const Json& postures) {
    const OctreeCollisions collisions(scene.octree());
    int number = 0;
    for (const Json& posture : postures) {
        bool collides = false;
        Json bodies = Json::array();
        for (const Json& body : posture) {
            bodies.push_back(collisions.touches(body_of(body)));
            collides = collides || bodies.back();
        }
        print({{"event", "posture"}, {"number", number++}, {"collides", collides}, {"bodies", bodies}});
    }
}

int stand_in(int count, char** words) {
    const Arguments arguments(count, words, {}, {"--root", "--frames", "--postures"});
    PlanningScene scene(frames_of(arguments));
    bool is_accepted = true;
    for (const std::string& path : arguments.rest()) {
        is_accepted = apply(scene, path) && is_accepted;
    }
    if (arguments.has("--postures")) {
        print_collisions(scene, read_json_file(arguments.text("--postures", "")));
    }
    return is_accepted ? 0 : 1;
}

}  // namespace
}  // namespace octoskin::ros

int main(int count, char** words) {
    return octoskin::ros::run_program(count, words, octoskin::ros::kUsage, &octoskin::ros::stand_in);
}
