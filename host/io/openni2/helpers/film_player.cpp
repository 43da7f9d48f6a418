// octoskin-film FILE.oni: plays a recording in place of a camera. It writes the frames at their own speed, in
// an endless loop, to standard output (frame_pipe.hpp), each with the time at which it is shown.
// octoskin-camera becomes this program when it gets a file. Drivers of cameras need many system calls, which
// a process that reads an untrusted file must not have; this process has no camera drivers.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "host/io/helper_limits/confinement.hpp"
#include "host/io/openni2/helpers/depth_stream.hpp"
#include "host/io/openni2/helpers/frame_stream.hpp"

namespace octoskin::openni2 {
namespace {

constexpr const char* kProgram = "octoskin-film";

/// A recording has no clock of its own. Its time stamps give only the pause between two frames: if OpenNI2
/// shows one late on a busy machine, all later ones are as late, and each loop begins after the previous one.
/// So the capture time of a frame is the moment at which it is shown. The frame is received then, or when
/// this thread next runs, at most one period later: otherwise the next frame would have replaced it.
Result<std::int64_t, std::string> shown_at(std::int64_t arrived_us) {
    return arrived_us;
}

int play(DepthStream& depth, const std::filesystem::path& film, int descriptor) {
    (void)confine_this_process(kProgram, NewThreads::allowed);
    if (!depth.is_sound(film, film.string())) return kUnsound;
    if (!depth.open(film.c_str()) || !depth.is_file()) return depth.complain("cannot open the film");
    openni::PlaybackControl* const playback = depth.playback();
    if (playback == nullptr) return depth.complain("it cannot be played");
    playback->setRepeatEnabled(true);
    playback->setSpeed(1.0F);
    if (!depth.start()) return 1;
    // A single frame would be repeated without a pause, because its duration is unknown.
    if (depth.frame_count() < 2) return depth.complain("it has fewer than two frames");
    return stream_frames(depth, descriptor, shown_at);
}

}  // namespace
}  // namespace octoskin::openni2

int main(int argc, char** argv) {
    using namespace octoskin::openni2;
    if (argc != 2) {
        std::fputs("usage: octoskin-film FILE.oni > frames\nA helper of octoskin; octoskin-camera runs it.\n",
                   stderr);
        return 2;
    }
    // OpenNI2 changes the working directory while it loads its drivers.
    const auto film = std::filesystem::absolute(argv[1]);
    const auto output = begin_helper(kProgram);
    if (!output) return 1;
    DepthStream depth(kProgram);
    end_helper(play(depth, film, *output));
}
