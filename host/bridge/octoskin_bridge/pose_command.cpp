// octoskin bridge pose: poses of cameras from /tf_static, as text for the rig.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/bridge/octoskin_bridge/commands.hpp"
#include "host/bridge/octoskin_bridge/wait_for.hpp"
#include "host/bridge/received/depth_image.hpp"
#include "host/bridge/received/frame_tree.hpp"
#include "host/bridge/received/unposed_rig.hpp"
#include "host/bridge/robot/robot_facts.hpp"

namespace octoskin::bridge {
namespace {

using app::CommandFailure;

struct PoseOptions {
    std::filesystem::path socket = default_control_socket();
    std::filesystem::path rig;
    std::string frame;
    int seconds = 10;
};

/// Frames of which a pose is asked, each on one of these links.
struct Wanted {
    std::vector<std::string> frames;
    std::vector<std::string> links;
};

CommandFailure not_found(const FrameTree& tree, const std::string& frame) {
    const auto near = tree.nearest(frame);
    return {
        ExitCode::unavailable,
        {.code = ErrorCode::no_data,
         .what = tree.why(frame),
         .remedy = near ? fmt::format("did you mean '{}'?", *near)
                        : "start the camera's driver and the publisher of the static transform between the "
                          "robot and the camera, or write the pose into the rig by hand"}};
}

/// The places of all frames, in their order. Throws CommandFailure if one is not known in time.
std::vector<FrameOnLink> wait_for_frames(const dds::Participant& participant, Deadline end,
                                         const Wanted& wanted) {
    FrameTree tree;
    const auto all = [&]() -> std::optional<std::vector<FrameOnLink>> {
        std::vector<FrameOnLink> found;
        for (const std::string& frame : wanted.frames)
            if (auto place = tree.from_link(frame, wanted.links)) found.push_back(std::move(*place));
        return found.size() == wanted.frames.size() ? std::optional(std::move(found)) : std::nullopt;
    };
    auto found = wait_for<ros::tf2_msgs::TFMessage>(participant, "/tf_static", end,
                                                    [&](const ros::tf2_msgs::TFMessage& message) {
                                                        tree.take(message);
                                                        return all();
                                                    });
    if (found) return *std::move(found);
    for (const std::string& frame : wanted.frames)
        if (!tree.from_link(frame, wanted.links)) throw not_found(tree, frame);
    return {};
}

Deadline end_of(const PoseOptions& options) {
    return std::chrono::steady_clock::now() + std::chrono::seconds(options.seconds);
}

void print_pose_of_frame(const PoseOptions& options) {
    const auto answer = ask_daemon(options.socket, "describe");
    if (!answer) throw CommandFailure(answer.error());
    const auto robot = robot_facts(nlohmann::ordered_json::parse(*answer, nullptr, false));
    if (!robot) throw CommandFailure(foreign_answer(options.socket));
    const auto participant = take_part();
    const Wanted wanted{.frames = {options.frame}, .links = robot->links};
    app::print_text(rig_text(wait_for_frames(*participant, end_of(options), wanted).front()));
}

/// The frame of a camera's images, from an image or its camera_info.
class CameraFrame {
  public:
    CameraFrame(const dds::Participant& participant, const std::string& topic)
        : participant_(&participant),
          images_(participant, topic,
                  is_compressed(topic) ? ros::sensor_msgs::CompressedImage::kType
                                       : ros::sensor_msgs::Image::kType,
                  dds::Durability::volatile_, 1, kWaitedBytesMax),
          info_(participant, info_topic(topic), ros::sensor_msgs::CameraInfo::kType,
                dds::Durability::transient_local, 1, kWaitedBytesMax) {}

    /// Empty: none came yet that names it.
    [[nodiscard]] std::optional<std::string> look() {
        auto found = is_compressed(images_.topic()) ? frame_of<ros::sensor_msgs::CompressedImage>(images_)
                                                    : frame_of<ros::sensor_msgs::Image>(images_);
        return found ? found : frame_of<ros::sensor_msgs::CameraInfo>(info_);
    }
    /// Why `look` is empty.
    [[nodiscard]] std::string why() const {
        if (images_.publishers() > 0)
            return fmt::format("no image with a frame_id came on {}", images_.topic());
        if (images_.other_type().empty()) return fmt::format("nothing publishes {}", images_.topic());
        return fmt::format("{} has messages of type {}", images_.topic(), images_.other_type());
    }

  private:
    template <cdr::Message M>
    std::optional<std::string> frame_of(Inlet& inlet) {
        return look_at<M>(*participant_, inlet, [](const M& message) -> std::optional<std::string> {
            const std::string& frame = message.header.frame_id;
            const std::size_t slash =
                frame.starts_with('/') ? 1 : 0;  // of drivers that were ported from ROS 1
            return frame.size() > slash ? std::optional(frame.substr(slash)) : std::nullopt;
        });
    }

    const dds::Participant* participant_;
    Inlet images_;
    Inlet info_;
};

std::string wait_for_frame_of(const dds::Participant& participant, Deadline end,
                              const UnposedCamera& camera) {
    CameraFrame frame(participant, camera.topic);
    auto found = wait_until(participant, end, [&] { return frame.look(); });
    if (found) return *std::move(found);
    throw CommandFailure(ExitCode::unavailable,
                         {.code = ErrorCode::no_data,
                          .what = fmt::format("{}: {}, so its frame is not known", camera.text, frame.why()),
                          .remedy = "start its driver, or correct `device` in the rig"});
}

void print_rig_with_poses(const PoseOptions& options) {
    if (auto refused = refused_to_read(options.rig)) throw CommandFailure(*refused);
    const auto rig = UnposedRig::read(options.rig);
    if (!rig) throw CommandFailure(reading_error(ExitCode::bad_config, rig.error()));
    const auto participant = take_part();
    const Deadline end = end_of(options);
    Wanted wanted{.frames = {}, .links = rig->links()};
    for (const UnposedCamera& camera : rig->cameras())
        wanted.frames.push_back(wait_for_frame_of(*participant, end, camera));
    const std::vector<FrameOnLink> found = wait_for_frames(*participant, end, wanted);
    std::vector<rig::CameraPose> poses;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const auto pose = rig->pose_of(rig->cameras()[i], found[i]);
        if (!pose) throw CommandFailure(ExitCode::bad_config, pose.error());
        poses.push_back(*pose);
    }
    const auto text = rig->text_with(poses);
    if (!text) throw CommandFailure(ExitCode::bad_config, text.error());
    app::print_text(*text);
}

void print_pose(const PoseOptions& options) {
    if (options.frame.empty() == options.rig.empty())
        throw CommandFailure(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                               .what = "expected a frame, or --rig with a rig",
                                               .remedy = "give one of them"});
    options.rig.empty() ? print_pose_of_frame(options) : print_rig_with_poses(options);
}

}  // namespace

void add_pose_command(CLI::App& app) {
    auto options = std::make_shared<PoseOptions>();
    CLI::App* command = app.add_subcommand("pose",
                                           "Print the pose of a camera's optical frame on the robot's links, "
                                           "from /tf_static, as text for the rig");
    command->add_option("frame", options->frame, "Frame of the depth images (header.frame_id)");
    command->add_option(
        "--rig", options->rig,
        "Print this rig with the pose of each camera that has `pose: tf`, of the frame of its "
        "images. No daemon is needed");
    command->add_option("--socket", options->socket, "Control socket of the daemon")->capture_default_str();
    command->add_option("--seconds", options->seconds, "How long to wait")
        ->check(CLI::Range(1, 600))
        ->capture_default_str();
    command->callback([options] { print_pose(*options); });
}

}  // namespace octoskin::bridge
