// octoskin-camera --list: which cameras there are (camera_list.hpp). octoskin-camera URI [MODE]: the depth
// frames of a camera to standard output (frame_pipe.hpp), each with the time of its capture on the host's
// monotonic clock. An .oni file as URI is a camera too: played at its own speed, again and again.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>

#include "host/io/openni2/capture_clock.hpp"
#include "host/io/openni2/helpers/camera_list.hpp"
#include "host/io/openni2/helpers/depth_stream.hpp"

namespace octoskin::openni2 {
namespace {

constexpr std::chrono::milliseconds kPatience{5'000};  // a daemon that takes no frames for so long is stuck

std::int64_t monotonic_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// A film has no clock of its own, and its stamps tell how long to wait between two frames, no more: what
/// OpenNI2 shows late on a busy machine makes all that follows as late, and each round begins when it does.
/// So a frame is of the moment at which it is shown. It is here by then, or as soon as this thread has its
/// turn: a period later at most, or the next frame would be here in its place.
int stream_frames(DepthStream& depth, int descriptor) {
    FramePipe output(descriptor, kPatience);
    if (!output.write_header({.size = depth.size(), .rate_mhz = depth.rate_mhz()})) return 1;
    CaptureClock clock;
    while (true) {  // until the camera is gone, or whoever reads
        if (!depth.wait_for_frame()) return depth.complain("no more frames");
        const std::int64_t arrived_us = monotonic_us();
        const auto stamp_us = static_cast<std::int64_t>(depth.frame().getTimestamp());
        const auto captured_us =
            depth.is_file() ? std::optional(arrived_us) : clock.captured_us(stamp_us, arrived_us);
        if (!captured_us) {
            if (!output.write_untimed_frame()) return 1;
            if (clock.is_lost()) return depth.complain("its frames came over 0.5 s late for 5 s");
            continue;
        }
        const auto pixels = depth.pixels();
        if (pixels.empty()) return depth.complain("a frame of another size");
        if (!output.write_frame(static_cast<std::uint64_t>(*captured_us), pixels)) return 1;
    }
}

int watch(DepthStream& depth, const char* uri, const std::optional<CameraMode>& mode, int descriptor) {
    std::error_code error;  // what cannot be looked at is no file, but a camera's address
    const std::filesystem::path film = uri == nullptr ? "" : uri;  // null: any camera
    if (std::filesystem::exists(film, error)) {
        if (!std::filesystem::is_regular_file(film, error)) return depth.complain("is no ordinary file");
        if (!depth.is_sound(film, film.string())) return kUnsound;
    }
    if (!depth.open(uri)) return depth.complain("cannot open the camera");
    if (openni::PlaybackControl* playback = depth.playback(); playback != nullptr) {
        playback->setRepeatEnabled(true);
        playback->setSpeed(1.0F);
    }
    if (!depth.start(mode)) return 1;
    // One would be shown without a pause, for nothing tells how long it shall stand.
    if (depth.is_file() && depth.frame_count() < 2) return depth.complain("it has fewer than two frames");
    return stream_frames(depth, descriptor);
}

int list_cameras(int descriptor) {
    const std::string text = camera_list();
    return ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) ? 0 : 1;
}

}  // namespace
}  // namespace octoskin::openni2

int main(int argc, char** argv) {
    using namespace octoskin::openni2;
    constexpr const char* kProgram = "octoskin-camera";
    const auto mode = argc == 3 ? parse_camera_mode(argv[2]) : std::nullopt;
    if (argc < 2 || argc > 3 || (argc == 3 && !mode)) {
        std::fputs(
            "usage: octoskin-camera URI|FILE.oni|'' [WIDTHxHEIGHT@HZ] > frames\n       octoskin-camera "
            "--list\nA helper of "
            "octoskin; `octoskin run` runs "
            "it.\n",
            stderr);
        return 2;
    }
    // OpenNI2 changes the working directory while it loads its drivers.
    std::error_code error;
    std::string uri = argv[1];
    if (std::filesystem::is_regular_file(uri, error)) uri = std::filesystem::absolute(uri).string();
    const auto output = begin_helper(kProgram);
    if (!output) return 1;
    if (uri == "--list") end_helper(list_cameras(*output));
    DepthStream depth(kProgram);
    end_helper(watch(depth, uri.empty() ? openni::ANY_DEVICE : uri.c_str(), mode, *output));
}
