#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/problems/unused_input.hpp"

namespace octoskin {
namespace {

/// Images were left out for over two seconds and still are: a short overload is not reported.
bool is_left_behind(const DaemonView& view) {
    constexpr Nanoseconds kLong{2'000'000'000};
    constexpr Nanoseconds kStill{1'000'000'000};
    const auto& last = view.used.depth_left_out;
    if (!last) return false;
    const Nanoseconds ago = view.now - *last;
    const Nanoseconds lasted = *last - *view.used.depth_left_out_since;
    return ago < kStill && lasted > kLong;
}

}  // namespace

std::optional<Problem> camera_problem(const CameraRecord& camera, double rate_hz, HostTime now) {
    constexpr Nanoseconds kFirstFrame{5'000'000'000};
    // Before "not open": a camera that is opened again and again in vain would alternate between the two.
    if (!camera.newest && now - camera.begun > kFirstFrame) {
        const std::string since =
            camera.frames > 0 ? fmt::format("{} frames came, none with a known capture time", camera.frames)
                              : "no frame has come yet";
        return Problem{.code = ProblemCode::camera_no_frames,
                       .on = "camera",
                       .what = since + (camera.is_open ? ", although it is open" : ": " + camera.why)};
    }
    if (!camera.is_open) {
        return Problem{
            .code = ProblemCode::camera_closed, .on = "camera", .what = camera.why, .detail = camera.why};
    }
    const double true_rate_hz = camera.rate_hz > 0.0 ? camera.rate_hz : rate_hz;
    const Nanoseconds period{static_cast<std::int64_t>(1e9 / true_rate_hz)};
    const auto is_near = [&](const std::optional<HostTime>& at) { return at && now - *at <= 3 * period; };
    const bool is_silent = camera.newest && !is_near(camera.newest);
    if (is_silent && is_near(camera.newest_untimed)) {
        return Problem{
            .code = ProblemCode::camera_untimed,
            .on = "camera",
            .what = "frames come, but for three periods none had a known capture time: they come late",
            .remedy = "is this machine too busy?"};
    }
    if ((is_silent || camera.repeats_often) && is_near(camera.newest_repeated)) {
        return Problem{.code = ProblemCode::camera_repeats,
                       .on = "camera",
                       .what =
                           "its images equal earlier ones bit by bit (repeated) and are not used: it "
                           "hangs, or its lens is covered",
                       .key = "repeated"};
    }
    if (is_silent) {
        return Problem{
            .code = ProblemCode::camera_silent, .on = "camera", .what = "no frame for three periods"};
    }
    return std::nullopt;
}

std::optional<Problem> camera_rate_problem(const CameraRecord& camera, double rate_hz) {
    constexpr double kAbout = 1.5;  // 30 Hz instead of 25 Hz is not reported
    const bool is_other = camera.rate_hz > kAbout * rate_hz || camera.rate_hz * kAbout < rate_hz;
    if (camera.rate_hz <= 0.0 || !is_other) return std::nullopt;
    return Problem{
        .code = ProblemCode::camera_rate,
        .on = "camera",
        .what = fmt::format("its mode with the rig's image size has {} frames a second, the rig {}",
                            camera.rate_hz, rate_hz),
        .remedy =
            "set camera.rate_hz of the rig to the rate of one of the camera's modes (`octoskin "
            "cameras` lists them)",
        .key = "camera.rate_hz"};
}

void add_pose_fault(const DaemonView& view, Problems& problems) {
    const CrossCheck* const cross_check = view.pipeline->builder().cross_check();
    if (cross_check == nullptr || !cross_check->pose().fault()) return;
    const PoseFault& fault = *cross_check->pose().fault();
    const ProblemCode code = !fault.joint    ? ProblemCode::camera_pose
                             : !fault.camera ? ProblemCode::joint_pose
                                             : ProblemCode::camera_or_joint_pose;
    problems.push_back({.code = code, .what = describe(fault, view.rig->joint_names())});
}

void add_camera(const DaemonView& view, Problems& problems) {
    add_pose_fault(view, problems);
    if (!view.camera || !view.rig->camera) return;
    const double rate_hz = view.rig->camera->rate_hz;
    const auto& frames = view.pipeline->inputs().depth_frames;
    const bool is_used = view.used.depth_frame && !has_stopped(view.used.depth_frame, view.now);
    const std::size_t others = problems.size();
    if (auto problem = camera_problem(*view.camera, rate_hz, view.now)) {
        problems.push_back(std::move(*problem));
    } else if (frames.in() > 0 && !is_used && view.inputs->has_bus_fallen_silent(view.now)) {
        problems.push_back({.code = ProblemCode::camera_bus_silent,
                            .on = "camera",
                            .what = "its frames are not used, because the bus is silent: no node sends joint "
                                    "states for the robot's pose (joints_missing)",
                            .key = "joints_missing"});
    } else if (view.is_listen_only && !view.inputs->foreign_clock().ahead(view.now)) {
        problems.push_back({.code = ProblemCode::camera_untimed,
                            .on = "camera",
                            .what = "its frames have no time: the clock of the host that sends SYNC is not "
                                    "known, or in doubt (three FOLLOW_UPs must agree)"});
    } else if (frames.in() > 0 && frames.rejected(DepthReason::wrong_size) == frames.in()) {
        const CameraIntrinsics& wanted = view.rig->camera->intrinsics;
        problems.push_back(
            {.code = ProblemCode::camera_size,
             .on = "camera",
             .what = fmt::format("none of its images is {} x {}, the size in the rig (wrong_size)",
                                 wanted.width, wanted.height),
             .remedy = "set camera.width_px and camera.height_px of the rig to those of one of the camera's "
                       "modes (`octoskin cameras` lists them)",
             .key = "wrong_size"});
    } else if (frames.in() > 0 && !view.used.depth_frame) {
        problems.push_back(
            {.code = ProblemCode::depth_unused,
             .what = "no depth frame could be used yet: " + see_counters("depth frames", frames)});
    } else if (has_stopped(view.used.depth_frame, view.now)) {
        problems.push_back(
            {.code = ProblemCode::depth_stopped,
             .what = "depth frames no longer reach the map: " + see_counters("depth frames", frames)});
    }
    if (problems.size() > others) problems.back().subject = "camera";
    if (is_left_behind(view)) {
        problems.push_back(
            {.code = ProblemCode::camera_overload,
             .on = "camera",
             .what = "its images come faster than this machine can process them, and some are left out "
                     "(queue_overflow)",
             .remedy = "use a coarser resolution_m, or a mode with a lower rate or fewer pixels",
             .key = "queue_overflow",
             .subject = "camera"});
    }
    if (auto problem = camera_rate_problem(*view.camera, rate_hz)) problems.push_back(std::move(*problem));
}

}  // namespace octoskin
