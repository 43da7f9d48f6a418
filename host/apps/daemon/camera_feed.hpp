// Depth frames of a live camera, read by a thread of its own: a camera that hangs stops nothing but itself.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/time.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/repeated_images.hpp"
#include "host/io/openni2/camera_mode.hpp"

namespace octoskin {

struct CameraRecord {
    bool is_open = false;
    std::uint64_t frames = 0;        ///< that came
    std::uint64_t displaced = 0;     ///< newer ones came before these were taken
    std::uint64_t untimed = 0;       ///< whose time of capture could not be told: late, or the first ones
    std::uint64_t repeated = 0;      ///< equal to earlier ones bit by bit (RepeatedImages): not used
    bool repeats_often = false;      ///< of the newest images more than a third did
    std::uint64_t opened = 0;        ///< times
    double rate_hz = 0.0;            ///< of the mode that it was put into; 0: not told, as of a file
    HostTime begun;                  ///< looked for since then
    std::optional<HostTime> newest;  ///< that has a time
    std::optional<HostTime> newest_untimed;   ///< came
    std::optional<HostTime> newest_repeated;  ///< came
    std::string why;                          ///< not open, for a person
};

class CameraFeed {
  public:
    /// Frames that wait; beyond, the oldest gives way.
    static constexpr std::size_t kWaitingMax = 3;
    /// A camera that is gone is looked for this often.
    static constexpr std::chrono::milliseconds kRetry{1'000};

    /// `uri`: an OpenNI2 device, or the path of an .oni file that is played at its own speed, again and
    /// again; empty: the first device there is. `silence_max`: a camera that shows nothing for so long is
    /// opened anew, and so is one whose frames all come late (openni2::CaptureClock::is_lost), and a device
    /// that shows its last images, with values, for so long, and new ones at most now and then: a film may.
    /// In the next opening these are repetitions from the first on. `helper`: the program that reads the
    /// camera, in place of octoskin-camera. `mode`: what a device is put into, if it has such a mode. Throws
    /// std::system_error if there is no thread or descriptor to be had.
    CameraFeed(std::string uri, std::chrono::milliseconds silence_max,
               std::optional<std::filesystem::path> helper = {},
               std::optional<openni2::CameraMode> mode = {});
    /// Within 2 s, whatever the camera does.
    ~CameraFeed();
    CameraFeed(const CameraFeed&) = delete;
    CameraFeed& operator=(const CameraFeed&) = delete;

    /// The camera is let go of, soon; no frame comes any more, and those that wait are there to be taken.
    /// Waits for nothing.
    void end();
    /// After `end`: the camera is let go of, and the destructor waits for nothing.
    [[nodiscard]] bool has_ended() const noexcept { return has_ended_; }

    /// Readable when a frame waits.
    [[nodiscard]] int descriptor() const noexcept { return event_; }
    [[nodiscard]] std::optional<DepthFrame> take();
    [[nodiscard]] CameraRecord record() const;

  private:
    void work();
    /// Until the camera ends or falls silent.
    void watch_camera();
    void put(DepthFrame frame);
    void note_opened(double rate_hz);
    void note_untimed();
    void note_repeated();
    void note_closed(const std::string& why);
    void wait_before_retry();

    std::string uri_;
    std::chrono::milliseconds silence_max_;
    std::optional<std::filesystem::path> helper_;
    std::optional<openni2::CameraMode> mode_;
    RepeatedImages images_;  ///< of all openings: a camera that hangs may go on with its image; the thread's
    int event_ = -1;
    int end_ = -1;  ///< readable when the thread is to end
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<DepthFrame> waiting_;
    CameraRecord record_;
    std::atomic<bool> is_ending_ = false;
    std::atomic<bool> has_ended_ = false;
    std::thread thread_;
};

}  // namespace octoskin
