#include "host/io/openni2/helpers/frame_stream.hpp"

#include <chrono>

#include "host/io/openni2/frame_pipe.hpp"

namespace octoskin::openni2 {
namespace {

constexpr std::chrono::milliseconds kPatience{
    5'000};  // a daemon that accepts no frame for this long is stuck

std::int64_t monotonic_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

int stream_frames(DepthStream& depth, int descriptor, const CaptureTime& capture_time) {
    FramePipe output(descriptor, kPatience);
    if (!output.write_header({.size = depth.size(), .rate_mhz = depth.rate_mhz()})) return 1;
    while (true) {  // until the device or the reader disappears
        if (!depth.wait_for_frame()) return depth.complain("no more frames");
        const auto captured_us = capture_time(monotonic_us());
        if (!captured_us) {
            if (!output.write_untimed_frame()) return 1;
            if (!captured_us.error().empty()) return depth.complain(captured_us.error());
            continue;
        }
        const auto pixels = depth.pixels();
        if (pixels.empty()) return depth.complain("a frame of another size");
        if (!output.write_frame(static_cast<std::uint64_t>(*captured_us), pixels)) return 1;
    }
}

}  // namespace octoskin::openni2
