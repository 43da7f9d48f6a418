// The depth of an OpenNI2 device or recording: opened, checked, frame by frame.
#pragma once

#include <OpenNI.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/io/openni2/camera_mode.hpp"
#include "host/io/openni2/frame_pipe.hpp"

namespace octoskin::openni2 {

/// Limits this process, moves standard output away from OpenNI2 (returned: where it is now) and starts
/// OpenNI2. Empty if that fails; `program` has then said why.
[[nodiscard]] std::optional<int> begin_helper(const char* program);

/// Exit code of a helper whose file OpenNI2 was not given.
inline constexpr int kUnsound = 65;

/// Ends this process at once, without clean-up: OpenNI2's shutdown may hang on a camera that is gone, or on a
/// damaged file.
[[noreturn]] void end_helper(int exit_code);

class DepthStream {
  public:
    /// `program`: who complains on standard error.
    explicit DepthStream(const char* program) : program_(program) {}

    /// False if the file is none that OpenNI2 can be given (oni_check.hpp); that is said then. `shown`: what
    /// messages call it. Reads all of it.
    [[nodiscard]] bool is_sound(const std::filesystem::path& oni, const std::string& shown) const;
    /// False if there is no such device or file, or OpenNI2 cannot read it.
    [[nodiscard]] bool open(const char* uri);
    /// False if it gives no depth in millimetres; that is said then. `wanted`: a camera is put into the mode
    /// of this size whose rate comes next, if it has one; else it stays in the mode that it begins with.
    [[nodiscard]] bool start(const std::optional<CameraMode>& wanted = std::nullopt);
    /// The next frame, within 2 s and 5 s of processor time; false if there is none.
    [[nodiscard]] bool wait_for_frame();

    /// 1, for an exit code.
    int complain(const std::string& what) const;

    /// After `open`: null for a camera.
    [[nodiscard]] openni::PlaybackControl* playback() { return device_.getPlaybackControl(); }
    [[nodiscard]] bool is_file() const { return device_.isFile(); }
    /// Of a recording.
    [[nodiscard]] int frame_count() { return playback()->getNumberOfFrames(stream_); }
    /// After `start`.
    [[nodiscard]] FrameSize size() const { return size_; }
    /// After `start`: of the mode that a camera is in; 0 for a file, whose mode may tell another one than it
    /// was recorded at.
    [[nodiscard]] std::uint32_t rate_mhz() const { return rate_mhz_; }
    /// The newest frame, and its pixels, as seen from the camera (never mirrored); empty if it is of another
    /// size.
    [[nodiscard]] const openni::VideoFrameRef& frame() const { return frame_; }
    [[nodiscard]] std::vector<std::uint16_t> pixels() const;

  private:
    void choose(const CameraMode& wanted);

    const char* program_;
    openni::Device device_;
    openni::VideoStream stream_;
    openni::VideoFrameRef frame_;
    FrameSize size_;
    std::uint32_t rate_mhz_ = 0;
    bool is_mirrored_ = false;
};

}  // namespace octoskin::openni2
