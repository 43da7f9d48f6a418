// octoskin-oni-read FILE.oni [NAME]: writes the depth frames of a recording to standard output
// (frame_pipe.hpp). OpenNI2 may crash or hang on a damaged file: that is why this is a separate process with
// limits.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "host/core/text/printable.hpp"
#include "host/io/helper_limits/confinement.hpp"
#include "host/io/helper_limits/helper_limits.hpp"
#include "host/io/openni2/helpers/depth_stream.hpp"
#include "host/io/openni2/helpers/oni_outline.hpp"
#include "host/io/openni2/helpers/oni_salvage.hpp"

namespace octoskin::openni2 {
namespace {

constexpr std::chrono::milliseconds kPatience{600'000};  // the reading program may pause as long as it wants
constexpr const char* kProgram = "octoskin-oni-read";

/// Far more than checking and playing need: a limit in case the file takes over this process.
std::uintmax_t processor_seconds_for(std::uintmax_t bytes) {
    return 600 + bytes / 1'000'000;
}

int stream_frames(DepthStream& depth, bool is_salvaged, int descriptor) {
    const int frame_count = depth.frame_count();
    FramePipe output(descriptor, kPatience);
    if (!output.write_header({.size = depth.size(), .is_salvaged = is_salvaged})) return 1;
    for (int read = 0; read < frame_count; ++read) {
        if (!depth.wait_for_frame()) {
            std::fprintf(stderr, "%s: only %d of %d frames\n", kProgram, read, frame_count);
            return 1;
        }
        // A frame in the wrong place would have the wrong time.
        if (depth.frame().getFrameIndex() != read + 1)
            return depth.complain("a frame is missing or out of place");
        const auto pixels = depth.pixels();
        if (pixels.empty()) return depth.complain("a frame of another size");
        if (!output.write_frame(depth.frame().getTimestamp(), pixels)) return 1;
    }
    return output.write_end() ? 0 : 1;
}

/// The file that OpenNI2 opens: the recording, or a copy of its complete frames if it has no end.
struct Input {
    std::string path;
    bool is_salvaged = false;
};

Input input_of(const std::filesystem::path& file, const char* shown) {
    const OniOutline outline = outline_of(file);
    if (outline.length || outline.frames == 0) return {file.string()};
    std::error_code error;
    const auto folder = std::filesystem::temp_directory_path(error);
    // A file without a name disappears with this process; it stays open until then.
    const int copy = error ? -1 : ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    const std::string path = "/proc/self/fd/" + std::to_string(copy);
    limit_file_size(kSalvageMax + (std::uintmax_t{64} << 20U));  // and the seek tables
    if (copy >= 0 && salvage(file, path)) return {path, true};
    std::fprintf(stderr,
                 "%s: %s: cut off, and its %u complete frames cannot be copied to %s (%ju MiB at most)\n",
                 kProgram, printable(shown).c_str(), outline.frames, folder.c_str(), kSalvageMax >> 20U);
    return {file.string()};
}

/// `shown`: the file's name in messages.
int read_recording(DepthStream& depth, const std::filesystem::path& file, const char* shown, int descriptor) {
    const Input input = input_of(file, shown);
    (void)confine_this_process(kProgram,
                               NewThreads::allowed);  // a copy, if needed, is complete at this point
    if (!depth.is_sound(input.path, shown)) return kUnsound;
    if (!depth.open(input.path.c_str()) || !depth.is_file()) {
        std::fprintf(stderr, "%s: %s: not an .oni recording, or one that is damaged or cut off\n", kProgram,
                     printable(shown).c_str());
        return 1;
    }
    openni::PlaybackControl* const playback = depth.playback();
    if (playback == nullptr) return depth.complain("it cannot be played");
    playback->setRepeatEnabled(false);
    playback->setSpeed(-1.0F);  // as fast as the reader accepts them, without dropping any
    return depth.start() ? stream_frames(depth, input.is_salvaged, descriptor) : 1;
}

}  // namespace
}  // namespace octoskin::openni2

int main(int argc, char** argv) {
    using namespace octoskin::openni2;
    if (argc != 2 && argc != 3) {
        std::fputs(
            "usage: octoskin-oni-read FILE.oni [NAME] > frames\nA helper of octoskin; `octoskin replay` runs "
            "it.\n",
            stderr);
        return 2;
    }
    // OpenNI2 changes the working directory while it loads its drivers.
    const auto file = std::filesystem::absolute(argv[1]);
    const auto output = begin_helper(kProgram);
    if (!output) return 1;
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file, error);
    octoskin::bound_processor_seconds(processor_seconds_for(error ? 0 : bytes));
    DepthStream depth(kProgram);
    end_helper(read_recording(depth, file, argv[argc - 1], *output));
}
