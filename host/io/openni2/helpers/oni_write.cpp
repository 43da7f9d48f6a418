// octoskin-oni-write FILE [NAME]: writes depth frames from standard input (frame_pipe.hpp) into a recording,
// with OpenNI2's recorder. NAME is the file's name in messages.
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "host/core/text/printable.hpp"
#include "host/io/helper_limits/helper_limits.hpp"
#include "host/io/openni2/frame_pipe.hpp"
#include "host/io/openni2/helper_process.hpp"
#include "host/io/openni2/helpers/oni_recorder.hpp"

namespace octoskin::openni2 {
namespace {

/// The recording program may pause as long as it wants; when it ends, this process ends, too.
constexpr std::chrono::milliseconds kPatience{24 * 3'600'000};
/// Frames wait in memory, because the recorder occupies a whole processor while it waits for one. This is a
/// minute of 512 x 424 at 10 Hz; a longer recording continues frame by frame.
constexpr std::size_t kWaitingMax = std::size_t{256} << 20U;

/// Frames from standard input, read ahead.
class Frames {
  public:
    explicit Frames(FrameSize size) : size_(size), waiting_max_(1 + kWaitingMax / (2 * size.pixels())) {}

    void read_ahead() {
        while (!is_over_ && waiting_.size() < waiting_max_) read();
    }
    /// Empty at the end, regular or not.
    std::optional<PipedFrame> next() {
        if (waiting_.empty() && !is_over_) read();
        if (waiting_.empty()) return std::nullopt;
        auto frame = std::move(waiting_.front());
        waiting_.pop_front();
        return frame;
    }
    /// The fault of the input; empty if it had its regular end.
    [[nodiscard]] const std::string& fault() const noexcept { return fault_; }

  private:
    void read() {
        auto frame = FramePipe(STDIN_FILENO, kPatience).read_frame(size_);
        if (!frame) fault_ = std::string("standard input: ") + name(frame.error());
        is_over_ = !frame || !frame->has_value();
        if (!is_over_) waiting_.push_back(std::move(**frame));
    }

    FrameSize size_;
    std::size_t waiting_max_;
    std::deque<PipedFrame> waiting_;
    bool is_over_ = false;
    std::string fault_;
};

/// Returns the error; empty if the recording is complete.
std::string record(const std::filesystem::path& file) {
    const auto header = FramePipe(STDIN_FILENO, kPatience).read_header();
    if (!header) return std::string("standard input: ") + name(header.error());
    if (!std::ofstream(file, std::ios::binary | std::ios::trunc)) return "cannot create the file";
    Frames frames(header->size);
    frames.read_ahead();
    OniRecorder recorder(file, header->size);
    if (std::string what = recorder.open(); !what.empty()) return what;
    const auto first = frames.next();
    if (std::string what = recorder.begin(first ? &*first : nullptr); !what.empty()) return what;
    while (const auto frame = frames.next()) {
        if (std::string what = recorder.record(*frame); !what.empty()) return what;
    }
    const std::string what = recorder.finish();
    return frames.fault().empty() ? what : frames.fault();
}

}  // namespace
}  // namespace octoskin::openni2

int main(int argc, char** argv) {
    if (argc != 2 && argc != 3) {
        std::fputs(
            "usage: octoskin-oni-write FILE [NAME] < frames\nA helper of octoskin; `octoskin-lab "
            "simulate` "
            "runs "
            "it.\n",
            stderr);
        return 2;
    }
    // After the daemon was killed, its last frames exist only here: they are still written to the file.
    octoskin::limit_this_process({.memory_mib = octoskin::openni2::kHelperMemoryMib,
                                  .exit_without_memory = octoskin::openni2::kOutOfMemory,
                                  .orphan = octoskin::Orphan::goes_on});
    std::signal(SIGTERM, SIG_IGN);
    // OpenNI2 changes the working directory while it loads its drivers.
    const auto file = std::filesystem::absolute(argv[1]);
    const std::string what = octoskin::openni2::record(file);
    if (!what.empty()) {
        std::fprintf(stderr, "octoskin-oni-write: %s\n",
                     octoskin::printable(std::string(argv[argc - 1]) + ": " + what).c_str());
    }
    // No clean-up: the file is closed, and OpenNI2's shutdown sometimes waits 3 s for a thread that it failed
    // to stop.
    std::_Exit(what.empty() ? 0 : 1);
}
