#include "hw/rigfile/camera_pose_edit.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>

#include "hw/rigfile/rig_keys.hpp"

namespace octoskin::rig {
namespace {

/// Where `pose: tf` is in the text.
struct PosePlace {
    std::size_t key = 0;     ///< first byte of the key
    std::size_t value = 0;   ///< first byte of the value
    std::size_t bytes = 0;   ///< of the value
    std::size_t column = 0;  ///< of the key
    bool is_flow = false;    ///< the camera is written in braces
};

std::vector<YAML::Node> cameras_of(const YAML::Node& top) {
    if (!top.IsMap()) return {};
    const YAML::Node one = top[std::string(name_of(keys::kCameraTable))];
    if (one && one.IsMap()) return {one};
    const YAML::Node list = top[std::string(name_of(keys::kCameras))];
    std::vector<YAML::Node> cameras;
    if (list && list.IsSequence())
        for (const YAML::Node& item : list) cameras.push_back(item);
    return cameras;
}

std::optional<PosePlace> place_in(const YAML::Node& camera, const std::string& text) {
    if (!camera.IsMap()) return std::nullopt;
    for (const auto& item : camera) {
        if (!item.first.IsScalar() || item.first.Scalar() != name_of(keys::camera::kPose)) continue;
        if (!item.second.IsScalar() || item.second.Scalar() != kPoseOfFrames) return std::nullopt;
        const auto begin = static_cast<std::size_t>(item.second.Mark().pos);
        const bool is_quoted = begin < text.size() && (text[begin] == '"' || text[begin] == '\'');
        const std::size_t first = begin + (is_quoted ? 1U : 0U);
        if (first > text.size() || text.compare(first, kPoseOfFrames.size(), kPoseOfFrames) != 0)
            return std::nullopt;
        return PosePlace{.key = static_cast<std::size_t>(item.first.Mark().pos),
                         .value = begin,
                         .bytes = kPoseOfFrames.size() + (is_quoted ? 2U : 0U),
                         .column = static_cast<std::size_t>(item.first.Mark().column),
                         .is_flow = camera.Style() == YAML::EmitterStyle::Flow};
    }
    return std::nullopt;
}

std::map<std::size_t, PosePlace> places_in(const std::string& text) {
    std::map<std::size_t, PosePlace> places;
    try {
        const std::vector<YAML::Node> cameras = cameras_of(YAML::Load(text));
        for (std::size_t i = 0; i < cameras.size(); ++i)
            if (const auto place = place_in(cameras[i], text)) places.emplace(i, *place);
    } catch (const YAML::Exception&) {
        places.clear();
    }
    return places;
}

std::string double_quoted(const std::string& text) {
    YAML::Emitter out;
    out << YAML::DoubleQuoted << text;
    return out.c_str();
}

std::string with_pose(const std::string& text, const PosePlace& place, const CameraPose& pose) {
    std::string before = text.substr(0, place.key);
    if (!pose.link.empty()) {
        before += fmt::format("{}: {}", name_of(keys::camera::kLink), double_quoted(pose.link));
        before += place.is_flow ? ", " : "\n" + std::string(place.column, ' ');
    }
    return before + text.substr(place.key, place.value - place.key) + pose_text(pose.T_link_camera) +
           text.substr(place.value + place.bytes);
}

}  // namespace

std::string pose_text(const Eigen::Isometry3d& T_link_camera) {
    const Eigen::Vector3d p = T_link_camera.translation();
    const Eigen::Quaterniond q = Eigen::Quaterniond(T_link_camera.linear()).normalized();
    return fmt::format("{{{}: [{:.6f}, {:.6f}, {:.6f}], {}: [{:.9f}, {:.9f}, {:.9f}, {:.9f}]}}",
                       name_of(keys::pose::kPosition), p.x(), p.y(), p.z(), name_of(keys::pose::kQuaternion),
                       q.w(), q.x(), q.y(), q.z());
}

std::vector<std::size_t> cameras_with_pose_of_frames(const std::string& text) {
    std::vector<std::size_t> cameras;
    for (const auto& [camera, place] : places_in(text)) cameras.push_back(camera);
    return cameras;
}

std::optional<std::string> with_camera_poses(const std::string& text,
                                             const std::map<std::size_t, CameraPose>& poses) {
    const std::map<std::size_t, PosePlace> places = places_in(text);
    std::string edited = text;
    for (auto pose = poses.rbegin(); pose != poses.rend(); ++pose) {  // the last first: places before it hold
        const auto place = places.find(pose->first);
        if (place == places.end()) return std::nullopt;
        edited = with_pose(edited, place->second, pose->second);
    }
    return edited;
}

}  // namespace octoskin::rig
