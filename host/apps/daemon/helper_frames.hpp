// Frames of an OpenNI2 device, or of an .oni file in its place, through a helper process.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "host/apps/daemon/frame_source.hpp"
#include "host/io/openni2/camera_mode.hpp"

namespace octoskin {

class HelperFrames final : public FrameSource {
  public:
    /// How often a camera that is gone is looked for.
    static constexpr std::chrono::milliseconds kRetry{1'000};

    /// `uri`: an OpenNI2 device, or the path of an .oni file, played at its own speed in a loop; empty: the
    /// first device. `silence_max`: it is closed if it shows nothing for this long. `helper`: the program
    /// that reads the camera, in place of octoskin-camera. `mode`: the mode to set, if the device has it.
    HelperFrames(std::string uri, std::chrono::milliseconds silence_max,
                 std::optional<std::filesystem::path> helper, std::optional<openni2::CameraMode> mode);

    [[nodiscard]] Result<std::unique_ptr<FrameStream>, std::string> open(int interrupt) override;
    [[nodiscard]] std::string why_at_first() const override { return "not opened yet"; }
    [[nodiscard]] std::string remedy() const override { return {}; }
    [[nodiscard]] bool may_repeat() const override;

  private:
    std::string uri_;
    std::chrono::milliseconds silence_max_;
    std::optional<std::filesystem::path> helper_;
    std::optional<openni2::CameraMode> mode_;
    bool was_tried_ = false;
};

}  // namespace octoskin
