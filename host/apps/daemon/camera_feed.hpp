// Depth frames of a live camera, read by its own thread: a camera that hangs blocks only that thread.
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
    std::uint64_t frames = 0;                 ///< received
    std::uint64_t displaced = 0;              ///< displaced by newer ones before they were taken
    std::uint64_t untimed = 0;                ///< without a known capture time: late, or the first ones
    std::uint64_t repeated = 0;               ///< equal to earlier ones bit by bit (RepeatedImages): not used
    bool repeats_often = false;               ///< over a third of the newest images were repeated
    std::uint64_t opened = 0;                 ///< number of times
    double rate_hz = 0.0;                     ///< of its mode; 0: not known, as for a file
    HostTime begun;                           ///< when the search for it began
    std::optional<HostTime> newest;           ///< the newest frame with a time
    std::optional<HostTime> newest_untimed;   ///< arrival of the newest one
    std::optional<HostTime> newest_repeated;  ///< arrival of the newest one
    std::string why;                          ///< why it is not open, for a person
};

class CameraFeed {
  public:
    /// Frames that wait; beyond this the oldest is displaced.
    static constexpr std::size_t kWaitingMax = 3;
    /// How often a camera that is gone is looked for.
    static constexpr std::chrono::milliseconds kRetry{1'000};

    /// `uri`: an OpenNI2 device, or the path of an .oni file, played at its own speed in a loop; empty: the
    /// first device. A camera is opened again if it shows nothing for `silence_max`; if its frames all come
    /// late (openni2::CaptureClock::is_lost); and if a device, for that long, repeats its last images with
    /// values and shows new ones only now and then (a film may do so). In the next opening these images count
    /// as repetitions from the first on. `helper`: the program that reads the camera, in place of
    /// octoskin-camera. `mode`: the mode to set, if the device has it. Throws std::system_error if there is
    /// no thread or descriptor left.
    CameraFeed(std::string uri, std::chrono::milliseconds silence_max,
               std::optional<std::filesystem::path> helper = {},
               std::optional<openni2::CameraMode> mode = {});
    /// Takes at most 2 s, whatever the camera does.
    ~CameraFeed();
    CameraFeed(const CameraFeed&) = delete;
    CameraFeed& operator=(const CameraFeed&) = delete;

    /// Releases the camera soon, without waiting. No new frame comes; those that wait can still be taken.
    void end();
    /// After `end`: the camera is released, and the destructor does not wait.
    [[nodiscard]] bool has_ended() const noexcept { return has_ended_; }

    /// Readable when a frame waits.
    [[nodiscard]] int descriptor() const noexcept { return event_; }
    [[nodiscard]] std::optional<DepthFrame> take();
    [[nodiscard]] CameraRecord record() const;

  private:
    void work();
    /// Returns when the camera ends or falls silent.
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
    RepeatedImages images_;  ///< of all openings, as a camera that hangs may repeat its image; the thread's
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
