#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/problems/unused_input.hpp"
#include "host/core/rig/camera_text.hpp"

namespace octoskin {
namespace {

/// Images were left out for over two seconds and still are: a short overload is not reported.
bool is_left_behind(const CameraUse& use, HostTime now) {
    constexpr Nanoseconds kLong{2'000'000'000};
    constexpr Nanoseconds kStill{1'000'000'000};
    if (!use.left_out) return false;
    const Nanoseconds ago = now - *use.left_out;
    const Nanoseconds lasted = *use.left_out - *use.left_out_since;
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
                       .what = since + (camera.is_open ? ", although it is open" : ": " + camera.why),
                       .remedy = camera.is_open ? "" : camera.remedy};
    }
    if (!camera.is_open) {
        return Problem{.code = ProblemCode::camera_closed,
                       .on = "camera",
                       .what = camera.why,
                       .remedy = camera.remedy,
                       .detail = camera.why};
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

namespace {

/// One camera of the view.
struct Looked {
    const HostCamera& of_rig;
    const CameraRecord& record;
    const InputCounters<DepthReason>& frames;
    CameraUse use;
    DepthStage::WrongSize wrong_size;
};

std::optional<Problem> unused_frames(const DaemonView& view, const Looked& camera) {
    const auto& [of_rig, record, frames, use, wrong_size] = camera;
    const Nanoseconds patience = std::max(kUnusedPatience, Nanoseconds{std::llround(3e9 / of_rig.rate_hz)});
    const bool is_used = use.frame && !has_stopped(use.frame, view.now, patience);
    CounterTable table = tabulate("depth frames", frames);
    table.of = of_rig.name;
    if (frames.in() > 0 && !is_used && view.inputs->has_bus_fallen_silent(view.now)) {
        return Problem{.code = ProblemCode::camera_bus_silent,
                       .on = camera_text(of_rig.name),
                       .what =
                           "its frames are not used, because the bus is silent: no node sends joint "
                           "states for the robot's pose (joints_missing)",
                       .key = "joints_missing"};
    }
    if (view.is_listen_only && !view.inputs->foreign_clock().ahead(view.now)) {
        return Problem{.code = ProblemCode::camera_untimed,
                       .on = camera_text(of_rig.name),
                       .what =
                           "its frames have no time: the clock of the host that sends SYNC is not "
                           "known, or in doubt (three FOLLOW_UPs must agree)"};
    }
    if (wrong_size.frames > 0 && !use.frame) {
        const CameraIntrinsics& wanted = of_rig.intrinsics;
        return Problem{
            .code = ProblemCode::camera_size,
            .on = camera_text(of_rig.name),
            .what =
                fmt::format("its images are {} x {}, and none is {} x {}, the size in the rig (wrong_size)",
                            wrong_size.width, wrong_size.height, wanted.width, wanted.height),
            .remedy =
                "set its width_px and height_px in the rig to the size of its images, with intrinsics for "
                "that size (`octoskin cameras` lists the modes of a device)",
            .key = "wrong_size"};
    }
    if (frames.in() > 0 && !use.frame) {
        return Problem{.code = ProblemCode::depth_unused,
                       .on = of_rig.name.empty() ? "" : camera_text(of_rig.name),
                       .what = "no depth frame could be used yet: " + see_counters(table)};
    }
    if (has_stopped(use.frame, view.now, patience)) {
        return Problem{.code = ProblemCode::depth_stopped,
                       .on = of_rig.name.empty() ? "" : camera_text(of_rig.name),
                       .what = table.title() + " no longer reach the map: " + see_counters(table)};
    }
    return std::nullopt;
}

Problem overload(const HostCamera& camera) {
    return {.code = ProblemCode::camera_overload,
            .on = camera_text(camera.name),
            .what =
                "its images come faster than this machine can process them, and some are left out "
                "(queue_overflow)",
            .remedy = "use a coarser resolution_m, or a mode with a lower rate or fewer pixels",
            .key = "queue_overflow"};
}

void add_camera(const DaemonView& view, const Looked& camera, Problems& problems) {
    const std::string subject = camera_text(camera.of_rig.name);
    const auto add = [&](std::optional<Problem> problem) {
        if (!problem) return;
        if (!problem->on.empty()) problem->on = subject;
        problem->subject = subject;
        problems.push_back(std::move(*problem));
    };
    auto problem = camera_problem(camera.record, camera.of_rig.rate_hz, view.now);
    add(problem ? std::move(problem) : unused_frames(view, camera));
    if (is_left_behind(camera.use, view.now)) add(overload(camera.of_rig));
    auto rate = camera_rate_problem(camera.record, camera.of_rig.rate_hz);
    if (!rate) return;
    rate->on = subject;
    problems.push_back(std::move(*rate));
}

/// Errors of cameras and joints that the comparison of images with ranges finds.
void add_pose_faults(const DaemonView& view, Problems& problems) {
    const CrossChecks* const checks = view.pipeline->builder().cross_checks();
    for (std::size_t i = 0; checks != nullptr && i < checks->cameras(); ++i) {
        const auto fault = checks->pose_fault(i);
        if (!fault) continue;
        const ProblemCode code = !fault->joint    ? ProblemCode::camera_pose
                                 : !fault->camera ? ProblemCode::joint_pose
                                                  : ProblemCode::camera_or_joint_pose;
        problems.push_back(
            {.code = code, .what = describe(*fault, view.rig->joint_names(), view.rig->cameras.at(i).name)});
    }
}

}  // namespace

void add_cameras(const DaemonView& view, Problems& problems) {
    add_pose_faults(view, problems);
    for (std::size_t i = 0; i < std::min(view.cameras.size(), view.rig->cameras.size()); ++i) {
        const CameraUse use = i < view.used.cameras.size() ? view.used.cameras[i] : CameraUse{};
        add_camera(view,
                   {view.rig->cameras.at(i), view.cameras[i], view.pipeline->inputs().depth_frames.at(i), use,
                    view.pipeline->builder().depth_stage(i).wrong_size()},
                   problems);
    }
}

}  // namespace octoskin
