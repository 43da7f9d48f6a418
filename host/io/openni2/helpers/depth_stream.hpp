// The depth stream of an OpenNI2 device or recording: opened, checked, read frame by frame.
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

/// Sets the limits of this process, moves standard output away from OpenNI2 (the new descriptor is returned)
/// and starts OpenNI2. Empty if that fails; `program` has then printed the reason.
[[nodiscard]] std::optional<int> begin_helper(const char* program);

/// Exit code of a helper that refused its file before OpenNI2 opened it.
inline constexpr int kUnsound = 65;

/// Ends this process at once, without clean-up: OpenNI2's shutdown may hang on a disconnected camera or a
/// damaged file.
[[noreturn]] void end_helper(int exit_code);

class DepthStream {
  public:
    /// `program`: name for messages on standard error.
    explicit DepthStream(const char* program) : program_(program) {}

    /// False if the file is not safe for OpenNI2 (oni_check.hpp); the reason is printed. `shown`: its name in
    /// messages. Reads the whole file.
    [[nodiscard]] bool is_sound(const std::filesystem::path& oni, const std::string& shown) const;
    /// False if the device or file does not exist, or OpenNI2 cannot read it.
    [[nodiscard]] bool open(const char* uri);
    /// False if its depth is not in millimetres; that is printed. `wanted`: a camera is set to its mode of
    /// this size with the nearest rate, if it has one; otherwise it keeps its initial mode.
    [[nodiscard]] bool start(const std::optional<CameraMode>& wanted = std::nullopt);
    /// Waits for the next frame, at most 2 s and 5 s of processor time; false if there is none.
    [[nodiscard]] bool wait_for_frame();

    /// Prints the message. Returns 1, for an exit code.
    int complain(const std::string& what) const;

    /// After `open`: null for a camera.
    [[nodiscard]] openni::PlaybackControl* playback() { return device_.getPlaybackControl(); }
    [[nodiscard]] bool is_file() const { return device_.isFile(); }
    /// For a recording.
    [[nodiscard]] int frame_count() { return playback()->getNumberOfFrames(stream_); }
    /// After `start`.
    [[nodiscard]] FrameSize size() const { return size_; }
    /// After `start`: the rate of a camera's present mode; 0 for a file, whose mode may differ from the
    /// recorded rate.
    [[nodiscard]] std::uint32_t rate_mhz() const { return rate_mhz_; }
    /// The latest frame and its pixels, as seen from the camera (never mirrored); empty if it has another
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
