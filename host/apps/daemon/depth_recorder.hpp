// Depth frames into an .oni file, by a thread of its own: the recorder of OpenNI2 takes its time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "host/apps/daemon/quiet_thread.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

class DepthRecorder {
  public:
    /// What may wait, in bytes of pixels: about 10 s of 512 x 424 at 30 Hz.
    static constexpr std::size_t kWaitingMax = std::size_t{128} << 20U;

    /// Touches nothing until `begin`; then makes the file with the first frame.
    DepthRecorder(FilePlace oni, FilePlace epoch);
    /// Drops what waits, unless `finish` was called and has ended. Within 0.1 s: a write that hangs is left
    /// behind.
    ~DepthRecorder();
    DepthRecorder(const DepthRecorder&) = delete;
    DepthRecorder& operator=(const DepthRecorder&) = delete;

    /// From now on the files may be made: whose folder that is has been found out.
    void begin();
    /// Frames of one size, in the order of their times. False if there is no room, or recording failed. Never
    /// waits.
    [[nodiscard]] bool add(const DepthFrame& frame);
    /// Waits until all are in the file and the file is whole, a minute at most. What went wrong, for a
    /// person; empty: nothing.
    [[nodiscard]] std::string finish();
    /// What went wrong so far; empty: nothing.
    [[nodiscard]] std::string error() const;

  private:
    class Work;
    std::shared_ptr<Work> work_;
    LeavableThread thread_;
};

}  // namespace octoskin
