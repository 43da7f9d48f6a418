// Writes depth frames into a recording, with OpenNI2's recorder in a helper process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/openni2/depth_epoch.hpp"
#include "host/io/openni2/frame_pipe.hpp"
#include "host/io/openni2/helper_process.hpp"

namespace octoskin::openni2 {

/// OpenNI2's codec is lossless up to this depth; larger ones are stored as 0 (none).
inline constexpr std::uint16_t kDepthMaxMm = 32767;

class OniWriter {
  public:
    /// Creates `oni` and, on `close`, its sidecar `epoch`; existing ones are removed. Errors: a missing
    /// helper, images of more than 1600 x 1200 pixels. `helper`: a program to use instead of the installed
    /// octoskin-oni-write.
    [[nodiscard]] static Result<OniWriter, Error> create(
        const FilePlace& oni, const FilePlace& epoch, FrameSize size,
        std::optional<std::filesystem::path> helper = std::nullopt);
    /// Frames must come in the order of their times. Asserts the size.
    [[nodiscard]] Status<Error> write(HostTime captured, std::span<const std::uint16_t> depth_mm);
    /// Waits for the recorder (3 ms for each of up to the last 600 frames of 512 x 424, fewer if larger) and
    /// writes the sidecar. Without this call the recording is incomplete. The bytes of the .oni depend on the
    /// frames only.
    [[nodiscard]] Status<Error> close();

  private:
    OniWriter(FilePlace oni, FilePlace epoch, FrameSize size, HelperProcess helper)
        : oni_(std::move(oni)), epoch_file_(std::move(epoch)), size_(size), helper_(std::move(helper)) {}
    [[nodiscard]] Unexpected<Error> failure(const std::string& what) const;
    [[nodiscard]] std::string why(const std::string& how);

    FilePlace oni_;
    FilePlace epoch_file_;
    FrameSize size_;
    HelperProcess helper_;
    DepthEpoch epoch_;
};

}  // namespace octoskin::openni2
