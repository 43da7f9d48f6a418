// Reads depth frames from a recording. OpenNI2 runs in a helper process, so that a damaged file can end only
// that process.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/openni2/depth_epoch.hpp"
#include "host/io/openni2/frame_pipe.hpp"
#include "host/io/openni2/helper_process.hpp"

namespace octoskin::openni2 {

class OniReader final : public DepthSource {
  public:
    /// Opens `oni` with its sidecar `epoch`. Errors name the file: missing, not a recording, cut off.
    /// `helper`: a program to use instead of the installed octoskin-oni-read.
    [[nodiscard]] static Result<OniReader, Error> open(
        const FilePlace& oni, const FilePlace& epoch,
        std::optional<std::filesystem::path> helper = std::nullopt);

    /// Opens an .oni without a sidecar: its first frame is at host time 0, and the number of frames is
    /// unknown.
    [[nodiscard]] static Result<OniReader, Error> open_alone(
        const FilePlace& oni, std::optional<std::filesystem::path> helper = std::nullopt);

    /// Waits at most 15 s for a frame. A recording with fewer frames than its sidecar states ends with an
    /// error after the last complete frame. One that was cut off ends there without an error, and loss()
    /// describes it. After an error every call returns that error.
    [[nodiscard]] Result<std::optional<DepthFrame>, Error> next() override;

    [[nodiscard]] FrameSize frame_size() const noexcept { return header_.size; }
    /// After the end, for the user: how much of a recording that was cut off was usable. Empty if it is
    /// complete.
    [[nodiscard]] std::optional<std::string> loss() const;

  private:
    OniReader(std::filesystem::path file, HelperProcess helper, const StreamHeader& header)
        : file_(std::move(file)), helper_(std::move(helper)), header_(header) {}
    [[nodiscard]] static Result<OniReader, Error> start(const FilePlace& oni,
                                                        std::optional<std::filesystem::path> helper);
    [[nodiscard]] Unexpected<Error> fail(const std::string& what);

    std::filesystem::path file_;
    HostTime first_frame_{};
    std::optional<std::uint64_t> frames_reported_;  ///< from the sidecar
    HelperProcess helper_;
    StreamHeader header_;
    std::uint64_t frames_read_ = 0;
    HostTime last_{};
    bool is_ended_ = false;
    std::optional<Error> failure_;
};

}  // namespace octoskin::openni2
