// Sends the images of one camera to the daemon, in a thread of its own: a daemon that is busy delays nothing
// else.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "common/time.hpp"
#include "host/bridge/received/depth_image.hpp"

namespace octoskin::bridge {

struct FrameSenderRecord {
    bool is_connected = false;
    std::uint64_t sent = 0;
    std::uint64_t displaced = 0;       ///< by newer ones, while the daemon took none
    std::string why = "no image yet";  ///< why it is not connected
};

class FrameSender {
  public:
    static constexpr std::size_t kWaitingMax = 6;  ///< 0.2 s at 30 Hz

    /// `control`: the daemon's control socket; `camera`: its name in the rig; may be empty. Throws
    /// std::system_error if there is no thread left.
    FrameSender(std::filesystem::path control, std::string camera, double rate_hz);
    /// Takes at most 2 s.
    ~FrameSender();
    FrameSender(const FrameSender&) = delete;
    FrameSender& operator=(const FrameSender&) = delete;

    /// `captured`: on this machine's monotonic clock. Throws std::bad_alloc.
    void send(HostTime captured, DepthPixels pixels);
    [[nodiscard]] FrameSenderRecord record() const;

  private:
    struct Frame {
        HostTime captured;
        DepthPixels pixels;
    };
    void run();
    [[nodiscard]] bool wait_for_frame();
    /// Sends frames until the connection or this object ends; returns why.
    [[nodiscard]] std::string serve(int connection);
    void wait_before_retry();
    void note(bool is_connected, std::string why);

    std::filesystem::path control_;
    std::string camera_;
    double rate_hz_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Frame> waiting_;
    FrameSenderRecord record_;
    bool is_ending_ = false;
    std::thread thread_;
};

}  // namespace octoskin::bridge
