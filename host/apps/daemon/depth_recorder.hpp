// Depth frames into an .oni file, by a thread of its own: the recorder of OpenNI2 takes its time.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

class DepthRecorder {
  public:
    /// What may wait, in bytes of pixels: about 10 s of 512 x 424 at 30 Hz.
    static constexpr std::size_t kWaitingMax = std::size_t{128} << 20U;

    /// Makes the file with the first frame.
    DepthRecorder(std::filesystem::path oni, std::filesystem::path epoch);
    /// Drops what waits, unless `finish` was called and has ended.
    ~DepthRecorder();
    DepthRecorder(const DepthRecorder&) = delete;
    DepthRecorder& operator=(const DepthRecorder&) = delete;

    /// Frames of one size, in the order of their times. False if there is no room, or recording failed. Never
    /// waits.
    [[nodiscard]] bool add(const DepthFrame& frame);
    /// Waits until all are in the file and the file is whole. What went wrong, for a person; empty: nothing.
    [[nodiscard]] std::string finish();
    /// What went wrong so far; empty: nothing.
    [[nodiscard]] std::string error() const;

  private:
    void work();
    /// Empty once no frame will come.
    [[nodiscard]] std::optional<DepthFrame> next();
    [[nodiscard]] std::string record();

    std::filesystem::path oni_;
    std::filesystem::path epoch_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<DepthFrame> waiting_;
    std::size_t waiting_bytes_ = 0;
    bool is_finishing_ = false;
    bool is_dropped_ = false;
    std::string error_;
    std::thread thread_;
};

}  // namespace octoskin
