#include "host/io/openni2/helpers/depth_stream.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/core/text/printable.hpp"
#include "host/io/helper_limits/helper_limits.hpp"
#include "host/io/openni2/helper_process.hpp"
#include "host/io/openni2/helpers/frame_pixels.hpp"
#include "host/io/openni2/helpers/oni_check.hpp"
#include "host/io/openni2/one_line.hpp"

namespace octoskin::openni2 {
namespace {

constexpr int kFrameTimeoutMs = 2'000;  // the end of a file appears only as missing frames

}  // namespace

std::optional<int> begin_helper(const char* program) {
    limit_this_process({.memory_mib = kHelperMemoryMib, .exit_without_memory = kOutOfMemory});
    allow_processor_seconds(kHelperProcessorSecondsPerFrame);
    const int output = take_standard_output();
    if (openni::OpenNI::initialize() == openni::STATUS_OK) return output;
    (void)DepthStream(program).complain("cannot start OpenNI2");
    return std::nullopt;
}

void end_helper(int exit_code) {
    std::fflush(nullptr);
    _exit(exit_code);
}

int DepthStream::complain(const std::string& what) const {
    const std::string why = one_line(openni::OpenNI::getExtendedError());
    const std::string said = printable(what + (why.empty() ? "" : ": ") + why);
    std::fprintf(stderr, "%s: %s\n", program_, said.c_str());
    return 1;
}

bool DepthStream::is_sound(const std::filesystem::path& oni, const std::string& shown) const {
    const auto fault = fault_of(oni, [] { allow_processor_seconds(kHelperProcessorSecondsPerFrame); });
    if (!fault) return true;
    std::fprintf(stderr, "%s: %s: at byte %ju: %s\n", program_, printable(shown).c_str(), fault->position,
                 printable(fault->what).c_str());
    return false;
}

bool DepthStream::open(const char* uri) {
    return device_.open(uri) == openni::STATUS_OK;
}

void DepthStream::choose(const CameraMode& wanted) {
    const openni::SensorInfo* const sensor = device_.getSensorInfo(openni::SENSOR_DEPTH);
    if (sensor == nullptr) return;
    const auto& modes = sensor->getSupportedVideoModes();
    const openni::VideoMode* nearest = nullptr;
    const auto off = [&wanted](const openni::VideoMode& mode) {
        return std::abs(mode.getFps() - wanted.rate_hz);
    };
    for (int i = 0; i < modes.getSize(); ++i) {
        const openni::VideoMode& mode = modes[i];
        const bool fits = mode.getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_1_MM &&
                          mode.getResolutionX() == static_cast<int>(wanted.width) &&
                          mode.getResolutionY() == static_cast<int>(wanted.height);
        if (fits && (nearest == nullptr || off(mode) < off(*nearest))) nearest = &mode;
    }
    if (nearest != nullptr && stream_.setVideoMode(*nearest) != openni::STATUS_OK)
        (void)complain("does not take the mode " + to_text(wanted));
}

bool DepthStream::start(const std::optional<CameraMode>& wanted) {
    const auto refuse = [this](const char* what) { return complain(what) == 0; };
    if (stream_.create(device_, openni::SENSOR_DEPTH) != openni::STATUS_OK)
        return refuse("it has no depth stream");
    if (wanted && !device_.isFile()) choose(*wanted);
    const auto size = depth_size(stream_);
    if (!size) return refuse("a video mode that octoskin cannot read");
    size_ = *size;
    if (!device_.isFile()) rate_mhz_ = 1000U * static_cast<std::uint32_t>(stream_.getVideoMode().getFps());
    // OpenNI2's drivers for cameras mirror the image by default. A file contains what was recorded; the
    // setting has no effect on it.
    if (!device_.isFile()) (void)stream_.setMirroringEnabled(false);
    is_mirrored_ = stream_.getMirroringEnabled();
    return stream_.start() == openni::STATUS_OK || refuse("cannot start the stream");
}

bool DepthStream::wait_for_frame() {
    allow_processor_seconds(kHelperProcessorSecondsPerFrame);
    openni::VideoStream* streams[] = {&stream_};
    int ready = -1;
    return openni::OpenNI::waitForAnyStream(streams, 1, &ready, kFrameTimeoutMs) == openni::STATUS_OK &&
           stream_.readFrame(&frame_) == openni::STATUS_OK;
}

std::vector<std::uint16_t> DepthStream::pixels() const {
    auto pixels = pixels_of(frame_, size_);
    if (!is_mirrored_) return pixels;
    for (auto row = pixels.begin(); row != pixels.end(); row += size_.width)
        std::reverse(row, row + size_.width);
    return pixels;
}

}  // namespace octoskin::openni2
