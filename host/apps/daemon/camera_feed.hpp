// Depth frames of a live camera, read by its own thread: a camera that hangs blocks only that thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/time.hpp"
#include "host/apps/daemon/frame_source.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/repeated_images.hpp"

namespace octoskin {

struct CameraRecord {
    bool is_open = false;
    std::uint64_t frames = 0;        ///< received
    std::uint64_t displaced = 0;     ///< displaced by newer ones before they were taken
    std::uint64_t untimed = 0;       ///< without a known capture time: late, or the first ones of a device
    std::uint64_t repeated = 0;      ///< equal to earlier ones bit by bit (RepeatedImages): not used
    bool repeats_often = false;      ///< over a third of the newest images were repeated
    std::uint64_t opened = 0;        ///< number of times
    double rate_hz = 0.0;            ///< of its mode; 0: not known, as for a file
    HostTime begun;                  ///< when the search for it began
    std::optional<HostTime> newest;  ///< the newest frame with a time
    std::optional<HostTime> newest_untimed;   ///< arrival of the newest one
    std::optional<HostTime> newest_repeated;  ///< arrival of the newest one
    std::string why;                          ///< why it is not open, for a person
    std::string remedy;                       ///< for a person, while it is not open; may be empty
};

class CameraFeed {
  public:
    /// Frames that wait; beyond this the oldest is displaced.
    static constexpr std::size_t kWaitingMax = 3;
    /// Without memory, a camera is opened again after this pause.
    static constexpr std::chrono::milliseconds kPause{1'000};

    /// A camera is opened again if its source closes it, as when it is silent for too long; if its frames all
    /// come late (openni2::CaptureClock::is_lost); and if, for `repeated_max`, it repeats its last images
    /// with values and shows new ones only now and then, unless its source may repeat them. In the next
    /// opening these images count as repetitions from the first on. Throws std::system_error if there is no
    /// thread or descriptor left.
    CameraFeed(std::unique_ptr<FrameSource> source, std::chrono::milliseconds repeated_max);
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
    /// Why it is to be closed; empty: it goes on.
    [[nodiscard]] std::string take_in(openni2::PipedFrame frame, openni2::FrameSize size);
    void put(DepthFrame frame);
    void note_opened(double rate_hz);
    void note_untimed();
    void note_repeated();
    void note_closed(const std::string& why);
    void pause() const;

    std::unique_ptr<FrameSource> source_;
    std::chrono::milliseconds repeated_max_;
    RepeatedImages images_;  ///< of all openings, as a camera that hangs may repeat its image; the thread's
    int event_ = -1;
    int end_ = -1;  ///< readable when the thread is to end
    mutable std::mutex mutex_;
    std::deque<DepthFrame> waiting_;
    CameraRecord record_;
    std::atomic<bool> is_ending_ = false;
    std::atomic<bool> has_ended_ = false;
    std::thread thread_;
};

}  // namespace octoskin
