// octoskin-film FILE.oni: a recording in a camera's place, its frames at their own speed, again and again, to
// standard output (frame_pipe.hpp), each with the time at which it is shown. octoskin-camera becomes this
// program when it is given a file: the drivers of cameras need too much of the system for a process that
// reads a foreign file, so here there are none.
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

/// A film has no clock of its own, and its stamps tell how long to wait between two frames, no more: what
/// OpenNI2 shows late on a busy machine makes all that follows as late, and each round begins when it does.
/// So a frame is of the moment at which it is shown. It is here by then, or as soon as this thread has its
/// turn: a period later at most, or the next frame would be here in its place.
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
    // One would be shown without a pause, for nothing tells how long it is to last.
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
