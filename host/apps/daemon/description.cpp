#include "host/apps/daemon/description.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "hw/rigfile/fed_device.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

Json pose_json(const Eigen::Isometry3d& T) {
    const Eigen::Vector3d p = T.translation();
    const Eigen::Quaterniond q = Eigen::Quaterniond(T.linear()).normalized();
    return {{"p", Json::array({p.x(), p.y(), p.z()})}, {"q", Json::array({q.x(), q.y(), q.z(), q.w()})}};
}

/// The empty name of a link is the base link.
const std::string& link_of(const std::string& link, const HostSetup& setup) {
    return link.empty() ? setup.frames.base_link : link;
}

Json vector_json(const Eigen::Vector3d& v) {
    return Json::array({v.x(), v.y(), v.z()});
}

const char* kind_name(JointKind kind) {
    switch (kind) {
        case JointKind::fixed:
            return "fixed";
        case JointKind::revolute:
            return "revolute";
        case JointKind::continuous:
            return "continuous";
        case JointKind::prismatic:
            return "prismatic";
    }
    return "";
}

Json joint_json(const JointDescription& joint) {
    Json json = {{"name", joint.name},
                 {"parent", joint.parent_link},
                 {"child", joint.child_link},
                 {"kind", kind_name(joint.kind)},
                 {"T_parent_joint", pose_json(joint.T_parent_joint)},
                 {"axis", vector_json(joint.axis)},
                 {"min", joint.limits.min},
                 {"max", joint.limits.max},
                 {"mimic", nullptr}};
    if (joint.mimic)
        json["mimic"] = {{"joint", joint.mimic->joint},
                         {"multiplier", joint.mimic->multiplier},
                         {"offset", joint.mimic->offset}};
    return json;
}

Json body_json(const HostRig& rig) {
    Json body = Json::array();
    for (const LinkCapsule& capsule : rig.body)
        body.push_back({{"link", capsule.link},
                        {"a", vector_json(capsule.p_link_a)},
                        {"b", vector_json(capsule.p_link_b)},
                        {"radius_m", capsule.radius_m}});
    return body;
}

Json joint_sources_json(const HostRig& rig) {
    Json sources = Json::array();
    for (const HostJointSource& source : rig.joint_sources)
        sources.push_back({{"node", source.node_id},
                           {"via", source.is_local ? "socket" : "can"},
                           {"rate_hz", source.rate_hz},
                           {"joints", source.joints}});
    return sources;
}

Json sensors_json(const HostSetup& setup) {
    Json sensors = Json::array();
    for (const HostNode& node : setup.rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            const HostSensor& sensor = node.sensors[i];
            sensors.push_back({{"node", node.node_id},
                               {"sensor", i},
                               {"node_name", node.name},
                               {"name", sensor.name},
                               {"link", link_of(sensor.link, setup)},
                               {"T_link_sensor", pose_json(sensor.T_link_sensor)},
                               {"fov_rad", sensor.fov_rad},
                               {"range_min_m", setup.rig.range_limits.min_m},
                               {"range_max_m", setup.rig.range_limits.max_m},
                               {"zones", sensor.zones.size()}});
        }
    }
    return sensors;
}

Json camera_json(const HostCamera& camera, const HostSetup& setup) {
    const CameraIntrinsics& lens = camera.intrinsics;
    return {{"name", camera.name},
            {"device", camera.device},
            {"link", link_of(camera.link, setup)},
            {"T_link_camera", pose_json(camera.T_link_camera)},
            {"width", lens.width},
            {"height", lens.height},
            {"fx", lens.fx},
            {"fy", lens.fy},
            {"cx", lens.cx},
            {"cy", lens.cy},
            {"depth_min_m", camera.depth_min_m},
            {"depth_max_m", camera.depth_max_m},
            {"rate_hz", camera.rate_hz},
            {"is_fed", rig::is_fed_device(camera.device)}};
}

}  // namespace

Json description_json(const HostSetup& setup, bool reads_cameras, std::uint64_t reloads) {
    Json cameras = Json::array();
    if (reads_cameras)
        for (const HostCamera& camera : setup.rig.cameras) cameras.push_back(camera_json(camera, setup));
    const RobotFrames& frames = setup.frames;
    Json joints = Json::array();
    for (const JointDescription& joint : frames.joints) joints.push_back(joint_json(joint));
    return {{"ok", true},
            {"rig", setup.rig.name},
            {"rig_hash", fmt::format("{:08x}", setup.rig.rig_hash)},
            {"reloads", reloads},
            {"root_link", frames.root_link},
            {"base_link", frames.base_link},
            {"T_root_base", pose_json(frames.T_root_base)},
            {"T_root_map", pose_json(frames.T_root_base * setup.rig.T_map_base.inverse())},
            {"links", frames.links},
            {"joints", std::move(joints)},
            {"body", body_json(setup.rig)},
            {"joint_sources", joint_sources_json(setup.rig)},
            {"sensors", sensors_json(setup)},
            {"cameras", std::move(cameras)}};
}

}  // namespace octoskin
