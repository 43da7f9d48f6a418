// Writes depth frames to an .oni file in its own thread, because the recorder of OpenNI2 is slow.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "host/apps/daemon/quiet_thread.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

class DepthRecorder {
  public:
    /// Bytes of pixels that may wait: about 10 s of 512 x 424 at 30 Hz.
    static constexpr std::size_t kWaitingMax = std::size_t{128} << 20U;

    /// Touches nothing before `begin`; then creates the file with the first frame.
    DepthRecorder(FilePlace oni, FilePlace epoch);
    /// Drops waiting frames, unless `finish` was called and has ended. Takes at most 0.1 s: a write that
    /// hangs is left behind.
    ~DepthRecorder();
    DepthRecorder(const DepthRecorder&) = delete;
    DepthRecorder& operator=(const DepthRecorder&) = delete;

    /// From now on the files may be created: the owner of the folder has been checked.
    void begin();
    /// Adds a frame; all have one size and come in the order of their times. False if there is no room, or
    /// recording failed. Never waits.
    [[nodiscard]] bool add(const DepthFrame& frame);
    /// Waits at most a minute until all frames are in the file and the file is complete. Returns the error;
    /// empty: none.
    [[nodiscard]] std::optional<Error> finish();
    /// The error so far; empty: none.
    [[nodiscard]] std::optional<Error> error() const;

  private:
    class Work;
    std::shared_ptr<Work> work_;
    LeavableThread thread_;
};

}  // namespace octoskin
