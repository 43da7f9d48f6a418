// octoskin-camera URI: the depth frames of a camera to standard output (frame_pipe.hpp), each with the time
// of its capture on the host's monotonic clock. An .oni file as URI is a camera too: played at its own speed,
// again and again.
#include <OpenNI.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <optional>

#include "host/io/openni2/capture_clock.hpp"
#include "host/io/openni2/frame_pipe.hpp"
#include "host/io/openni2/helpers/frame_pixels.hpp"
#include "host/io/openni2/helpers/helper_limits.hpp"

namespace octoskin::openni2 {
namespace {

constexpr std::chrono::milliseconds kPatience{5'000};  // a daemon that takes no frames for so long is stuck
constexpr int kFrameTimeoutMs = 2'000;
constexpr unsigned kProcessorSecondsPerFrame = 5;

int complain(const char* what) {
    std::fprintf(stderr, "octoskin-camera: %s: %s\n", what, openni::OpenNI::getExtendedError());
    return 1;
}

std::int64_t monotonic_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

int stream_frames(openni::VideoStream& stream, FrameSize size, int descriptor) {
    FramePipe output(descriptor, kPatience);
    if (!output.write_header({.size = size})) return 1;
    openni::VideoStream* streams[] = {&stream};
    openni::VideoFrameRef frame;
    CaptureClock clock;
    while (true) {  // until the camera is gone, or whoever reads
        allow_processor_seconds(kProcessorSecondsPerFrame);
        int ready = -1;
        if (openni::OpenNI::waitForAnyStream(streams, 1, &ready, kFrameTimeoutMs) != openni::STATUS_OK ||
            stream.readFrame(&frame) != openni::STATUS_OK) {
            return complain("no more frames");
        }
        const std::int64_t captured_us =
            clock.captured_us(static_cast<std::int64_t>(frame.getTimestamp()), monotonic_us());
        const auto pixels = pixels_of(frame, size);
        if (pixels.empty()) return complain("a frame of another size");
        if (!output.write_frame(static_cast<std::uint64_t>(captured_us), pixels)) return 1;
    }
}

int watch(const char* uri, int descriptor) {
    openni::Device device;
    openni::VideoStream stream;
    if (device.open(uri) != openni::STATUS_OK) return complain("cannot open the camera");
    if (stream.create(device, openni::SENSOR_DEPTH) != openni::STATUS_OK)
        return complain("it has no depth stream");
    if (openni::PlaybackControl* playback = device.getPlaybackControl(); playback != nullptr) {
        playback->setRepeatEnabled(true);
        playback->setSpeed(1.0F);
    }
    const auto size = depth_size(stream);
    if (!size) return complain("a video mode that octoskin does not read");
    if (stream.start() != openni::STATUS_OK) return complain("cannot start the stream");
    const int outcome = stream_frames(stream, *size, descriptor);
    // No clean-up: OpenNI2's shutdown may hang on a camera that is gone.
    std::fflush(nullptr);
    _exit(outcome);
}

}  // namespace
}  // namespace octoskin::openni2

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs(
            "usage: octoskin-camera URI|FILE.oni|'' > frames\nA helper of octoskin; `octoskin run` runs "
            "it.\n",
            stderr);
        return 2;
    }
    octoskin::openni2::limit_this_process();
    octoskin::openni2::allow_processor_seconds(octoskin::openni2::kProcessorSecondsPerFrame);
    const int descriptor = octoskin::openni2::take_standard_output();
    // OpenNI2 changes the working directory while it loads its drivers.
    std::error_code error;
    std::string uri = argv[1];
    if (std::filesystem::is_regular_file(uri, error)) uri = std::filesystem::absolute(uri).string();
    if (openni::OpenNI::initialize() != openni::STATUS_OK)
        return octoskin::openni2::complain("cannot start OpenNI2");
    return octoskin::openni2::watch(uri.empty() ? openni::ANY_DEVICE : uri.c_str(), descriptor);
}
