// octoskin-oni-read FILE.oni: the depth frames of a recording to standard output (frame_pipe.hpp). OpenNI2
// may crash or hang on a damaged file: that is why this is a process of its own, with limits.
#include <OpenNI.h>
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "host/io/openni2/frame_pipe.hpp"
#include "host/io/openni2/helpers/frame_pixels.hpp"
#include "host/io/openni2/helpers/helper_limits.hpp"
#include "host/io/openni2/helpers/oni_outline.hpp"
#include "host/io/openni2/helpers/oni_salvage.hpp"

namespace octoskin::openni2 {
namespace {

constexpr std::chrono::milliseconds kPatience{600'000};  // the reader may think as long as it likes
constexpr int kFrameTimeoutMs = 2000;                    // the end of a file shows only as silence
constexpr unsigned kProcessorSecondsPerFrame = 5;

int complain(const char* what) {
    std::fprintf(stderr, "octoskin-oni-read: %s: %s\n", what, openni::OpenNI::getExtendedError());
    return 1;
}

int stream_frames(openni::VideoStream& stream, int frame_count, const StreamHeader& header, int descriptor) {
    const FrameSize size = header.size;
    FramePipe output(descriptor, kPatience);
    if (!output.write_header(header)) return 1;
    openni::VideoStream* const streams[] = {&stream};
    openni::VideoFrameRef frame;
    for (int read = 0; read < frame_count; ++read) {
        allow_processor_seconds(kProcessorSecondsPerFrame);
        int ready = -1;
        if (openni::OpenNI::waitForAnyStream(const_cast<openni::VideoStream**>(streams), 1, &ready,
                                             kFrameTimeoutMs) != openni::STATUS_OK ||
            stream.readFrame(&frame) != openni::STATUS_OK) {
            std::fprintf(stderr, "octoskin-oni-read: only %d of %d frames\n", read, frame_count);
            return 1;
        }
        // A frame in the wrong place would be a frame at the wrong time.
        if (frame.getFrameIndex() != read + 1) return complain("a frame is missing or out of place");
        const auto pixels = pixels_of(frame, size);
        if (pixels.empty()) return complain("a frame of another size");
        if (!output.write_frame(frame.getTimestamp(), pixels)) return 1;
    }
    return output.write_end() ? 0 : 1;
}

/// What OpenNI2 is to open: the recording, or a copy of its whole frames if it has no end.
struct Input {
    std::string path;
    bool is_salvaged = false;
};

Input input_of(const std::filesystem::path& file) {
    const OniOutline outline = outline_of(file);
    if (outline.length || outline.frames == 0) return {file.string()};
    std::error_code error;
    const auto folder = std::filesystem::temp_directory_path(error);
    // Without a name, so that it goes when this process does; left open until then.
    const int copy = error ? -1 : ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    const std::string path = "/proc/self/fd/" + std::to_string(copy);
    if (copy >= 0 && salvage(file, path)) return {path, true};
    std::fprintf(stderr,
                 "octoskin-oni-read: %s: cut off, and there is no copying its %u whole frames to %s\n",
                 file.c_str(), outline.frames, folder.c_str());
    return {file.string()};
}

int read_recording(const std::filesystem::path& file, int descriptor) {
    openni::Device device;
    openni::VideoStream stream;
    const Input input = input_of(file);
    if (device.open(input.path.c_str()) != openni::STATUS_OK || !device.isFile()) {
        std::fprintf(stderr, "octoskin-oni-read: %s: not an .oni recording, or a damaged or cut off one\n",
                     file.c_str());
        return 1;
    }
    openni::PlaybackControl* playback = device.getPlaybackControl();
    if (playback == nullptr || stream.create(device, openni::SENSOR_DEPTH) != openni::STATUS_OK) {
        return complain("the recording has no depth stream");
    }
    playback->setRepeatEnabled(false);
    playback->setSpeed(-1.0F);  // as fast as they are taken, and none dropped
    const auto size = depth_size(stream);
    if (!size) return complain("a video mode that octoskin does not read");
    if (stream.start() != openni::STATUS_OK) return complain("cannot start the stream");
    const int outcome =
        stream_frames(stream, playback->getNumberOfFrames(stream), {*size, input.is_salvaged}, descriptor);
    // No clean-up: this process ends here, and OpenNI2's shutdown is one more thing that may hang on a
    // damaged file.
    std::fflush(nullptr);
    _exit(outcome);
}

}  // namespace
}  // namespace octoskin::openni2

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs(
            "usage: octoskin-oni-read FILE.oni > frames\nA helper of octoskin; `octoskin replay` runs it.\n",
            stderr);
        return 2;
    }
    octoskin::openni2::limit_this_process();
    octoskin::openni2::allow_processor_seconds(octoskin::openni2::kProcessorSecondsPerFrame);
    const int descriptor = octoskin::openni2::take_standard_output();
    // OpenNI2 changes the working directory while it loads its drivers.
    const auto file = std::filesystem::absolute(argv[1]);
    if (openni::OpenNI::initialize() != openni::STATUS_OK)
        return octoskin::openni2::complain("cannot start OpenNI2");
    return octoskin::openni2::read_recording(file, descriptor);
}
