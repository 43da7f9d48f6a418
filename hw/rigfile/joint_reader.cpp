#include "hw/rigfile/joint_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/rig_keys.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin::rig {
namespace {

/// The moving joints of the robot, and those that the sources read so far have.
struct Joints {
    const UrdfDocument& robot;
    std::vector<std::string> moving;
    std::vector<std::string> named;
};

std::string file_of(const Joints& joints) {
    return joints.robot.file().filename().string();
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

std::vector<std::string> read_names(const Table& table, Joints& joints) {
    const std::string path = table.path_of(keys::joints::kNames);
    const Value& list = table.require(keys::joints::kNames);
    std::vector<std::string> names;
    for (const Value& item : read_list(list, path)) {
        auto name = read_element_name(item, path);
        if (!has(joints.moving, name)) {
            fail(item, path,
                 {ErrorCode::unknown_name, fmt::format("expected a moving joint of {}", file_of(joints)),
                  fmt::format("'{}'", name), "it has " + joined(joints.moving)});
        }
        if (has(joints.named, name)) {
            fail(item, path,
                 {ErrorCode::duplicate, "expected each joint once", fmt::format("'{}' again", name)});
        }
        joints.named.push_back(name);
        names.push_back(std::move(name));
    }
    if (names.size() > wire::kJointsPerSample) {
        fail(list, path,
             {ErrorCode::limit_exceeded, fmt::format("expected 1 to {} joints", wire::kJointsPerSample),
              fmt::format("{} in {}", names.size(), file_of(joints)),
              "make `joints` a list of sources, each with up to seven of them"});
    }
    return names;
}

/// A node with sensors may not send joint states, and a source has an id of its own.
void refuse_used_id(const Table& table, std::uint8_t node_id, const std::vector<JointSource>& sources,
                    const Rig& rig) {
    const auto refuse = [&](const std::string& remedy) {
        table.fail(keys::joints::kNodeId,
                   {ErrorCode::duplicate, "expected a unique id", std::to_string(node_id), remedy});
    };
    for (const Node& node : rig.nodes)
        if (node.config.node_id == node_id) refuse(fmt::format("node '{}' has it", node.name));
    for (const JointSource& source : sources)
        if (source.node_id == node_id) refuse("another source of joint states has it");
}

void refuse_empty(const Table& table, const JointSource& source, const Joints& joints) {
    if (!source.joints.empty()) return;
    table.fail(keys::joints::kNames,
               {ErrorCode::limit_exceeded, fmt::format("expected 1 to {} joints", wire::kJointsPerSample),
                "0 in " + file_of(joints), "make those that stay as they are type=\"fixed\" there"});
}

JointSource read_source(const Table& table, const std::vector<JointSource>& sources, const Rig& rig,
                        Joints& joints) {
    JointSource source;
    source.node_id = table.integer<std::uint8_t>(keys::joints::kNodeId);
    refuse_used_id(table, source.node_id, sources, rig);
    source.joints = read_names(table, joints);
    source.rate_hz = table.number(keys::joints::kRate);
    source.way = table.choice(keys::joints::kWay);
    return source;
}

void refuse_unnamed(const Value& value, const std::string& path, const Joints& joints) {
    std::vector<std::string> unnamed;
    std::ranges::copy_if(joints.moving, std::back_inserter(unnamed),
                         [&](const std::string& name) { return !has(joints.named, name); });
    const std::string fix = "make each joint that does not move type=\"fixed\" in " + file_of(joints);
    if (joints.moving.size() > keys::joints::kNamesMax) {
        fail(value, path,
             {ErrorCode::limit_exceeded,
              fmt::format("expected at most {} moving joints", keys::joints::kNamesMax),
              fmt::format("{} in {}{}", joints.moving.size(), file_of(joints),
                          unnamed.empty() ? "" : "; not named are " + joined(unnamed)),
              fix});
    }
    if (unnamed.empty()) return;
    const bool has_room = joints.moving.size() <= wire::kJointsPerSample;
    fail(value, path,
         {ErrorCode::missing_key,
          fmt::format("expected every moving joint of {}, because the position of a joint without a name is "
                      "unknown",
                      file_of(joints)),
          "none named " + joined(unnamed),
          has_room ? "name it, or " + fix
                   : "name it in another source (`joints` may be a list, each with up to seven), or " + fix});
}

}  // namespace

std::vector<JointSource> read_joint_sources(const Value& value, const UrdfDocument& robot, const Rig& rig) {
    const std::string path(name_of(keys::kJointsTable));
    Joints joints{robot, robot.moving_joints(rig.base_link), {}};
    std::vector<JointSource> sources;
    if (value.kind != Value::Kind::list) {
        const Table table(value, path, keys::kJoints);
        sources.push_back(read_source(table, sources, rig, joints));
        refuse_unnamed(table.require(keys::joints::kNames), table.path_of(keys::joints::kNames), joints);
        refuse_empty(table, sources.back(), joints);
        return sources;
    }
    if (value.items.empty() || value.items.size() > static_cast<std::size_t>(keys::joints::kSources.max)) {
        fail(value, path,
             {ErrorCode::limit_exceeded, fmt::format("expected 1 to {} sources", keys::joints::kSources.max),
              std::to_string(value.items.size())});
    }
    for (std::size_t i = 0; i < value.items.size(); ++i) {
        const Table table(value.items[i], fmt::format("{}[{}]", path, i), keys::kJoints);
        sources.push_back(read_source(table, sources, rig, joints));
        refuse_empty(table, sources.back(), joints);
    }
    refuse_unnamed(value, path, joints);
    return sources;
}

}  // namespace octoskin::rig
