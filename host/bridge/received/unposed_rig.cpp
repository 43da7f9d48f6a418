#include "host/bridge/received/unposed_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <map>
#include <utility>

#include "host/core/rig/camera_text.hpp"
#include "host/io/folder/file_place.hpp"
#include "hw/rigfile/fed_device.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::bridge {
namespace {

constexpr std::size_t kRigBytesMax = std::size_t{256} << 10U;

/// Why the file has no camera whose pose is to be taken: the rig's own error, if it has one.
Error no_unposed_camera(const std::filesystem::path& file) {
    if (const auto rig = rig::read_rig(file); !rig) return rig.error();
    return {.code = ErrorCode::no_content,
            .what = "no camera of this rig has `pose: tf`",
            .remedy = "write it into each camera whose pose is to be taken from /tf_static",
            .file = file};
}

Result<UnposedCamera, Error> unposed(const rig::Rig& rig, std::size_t index,
                                     const std::filesystem::path& file) {
    const rig::Camera& camera = rig.cameras[index];
    if (!rig::is_fed_device(camera.device))
        return unexpected(Error{.code = ErrorCode::conflict,
                                .what = camera_text(camera.name) + " has `pose: tf` and no topic of images",
                                .value = fmt::format("'{}'", camera.device),
                                .remedy = "write `device: ros:/TOPIC`, or the pose",
                                .file = file,
                                .key = "device"});
    return UnposedCamera{.index = index,
                         .text = camera_text(camera.name),
                         .topic = camera.device.substr(rig::kFedDevice.size()),
                         .link = camera.link.empty() ? rig.base_link : camera.link,
                         .has_link = !camera.link.empty()};
}

}  // namespace

Result<UnposedRig, Error> UnposedRig::read(const std::filesystem::path& file) {
    const FilePlace place(file);
    auto text = place.read(kRigBytesMax);
    if (!text) return unexpected(no_unposed_camera(file));
    UnposedRig unposed_rig(file, std::move(text).value());
    std::map<std::size_t, rig::CameraPose> any;
    for (const std::size_t camera : rig::cameras_with_pose_of_frames(unposed_rig.text_))
        any.emplace(camera, rig::CameraPose{});
    const auto posed = rig::with_camera_poses(unposed_rig.text_, any);
    if (any.empty() || !posed) return unexpected(no_unposed_camera(file));
    const auto rig = rig::read_rig(FilePlace::held(*posed, place));
    if (!rig) return unexpected(rig.error());
    for (const auto& [index, pose] : any) {
        auto camera = unposed(*rig, index, file);
        if (!camera) return unexpected(camera.error());
        unposed_rig.cameras_.push_back(std::move(camera).value());
    }
    auto frames = read_robot_frames(rig->urdf, rig->base_link);
    if (!frames) return unexpected(frames.error());
    unposed_rig.take_robot(std::move(frames).value());
    return unposed_rig;
}

void UnposedRig::take_robot(RobotFrames frames) {
    joints_ = std::move(frames.joints);
    links_ = {frames.base_link};
    for (const JointDescription& joint : joints_) links_.push_back(joint.child_link);
    if (frames.root_link == frames.base_link) return;
    links_.push_back(frames.root_link);
    joints_.push_back({.name = {},
                       .parent_link = std::move(frames.root_link),
                       .child_link = std::move(frames.base_link),
                       .T_parent_joint = frames.T_root_base,
                       .limits = {}});
}

FrameOnLink UnposedRig::carrier_of(const std::string& link) const {
    FrameOnLink carried{.link = link};
    for (std::size_t step = 0; step < joints_.size(); ++step) {
        const auto joint = std::ranges::find(joints_, carried.link, &JointDescription::child_link);
        if (joint == joints_.end() || joint->kind != JointKind::fixed) break;
        carried = {joint->parent_link, joint->T_parent_joint * carried.T_link_frame};
    }
    return carried;
}

Result<rig::CameraPose, Error> UnposedRig::pose_of(const UnposedCamera& camera,
                                                   const FrameOnLink& frame) const {
    const FrameOnLink of_rig = carrier_of(camera.link);
    const FrameOnLink of_frame = carrier_of(frame.link);
    if (of_rig.link == of_frame.link)
        return rig::CameraPose{.T_link_camera = of_rig.T_link_frame.inverse() * of_frame.T_link_frame *
                                                frame.T_link_frame};
    if (!camera.has_link) return rig::CameraPose{.link = frame.link, .T_link_camera = frame.T_link_frame};
    return unexpected(Error{
        .code = ErrorCode::conflict,
        .what = fmt::format("a joint moves {}'s link against that from which its frame hangs", camera.text),
        .value = fmt::format("'{}' and '{}'", camera.link, frame.link),
        .remedy = fmt::format("write `link: {}` into the rig, or correct the transform", frame.link),
        .file = file_,
        .key = "link"});
}

Result<std::string, Error> UnposedRig::text_with(std::span<const rig::CameraPose> poses) const {
    assert(poses.size() == cameras_.size());
    std::map<std::size_t, rig::CameraPose> by_index;
    for (std::size_t i = 0; i < poses.size(); ++i) by_index.emplace(cameras_[i].index, poses[i]);
    auto text = rig::with_camera_poses(text_, by_index);
    assert(text);
    if (const auto rig = rig::read_rig(FilePlace::held(*text, file_)); !rig) return unexpected(rig.error());
    return std::move(text).value();
}

}  // namespace octoskin::bridge
