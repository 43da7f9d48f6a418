// Frames of a camera that another program feeds: through a connection of the control socket, in the format of
// frame_pipe.hpp.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "common/result.hpp"
#include "host/apps/daemon/frame_source.hpp"
#include "host/apps/daemon/wake_event.hpp"

namespace octoskin {

class FedFrames final : public FrameSource {
  public:
    /// A frame is untimed if it is older than this at its arrival, as one of a device is...
    static constexpr std::chrono::milliseconds kLateMax{500};
    /// ... or this far in the future: no clock that is set right gives it.
    static constexpr std::chrono::milliseconds kAheadMax{50};

    /// `device`: "ros:" and a topic. `size`: of its images. `silence_max`: for this long a feeder may send no
    /// whole frame. Throws std::system_error if there is no descriptor left.
    FedFrames(std::string device, openni2::FrameSize size, std::chrono::milliseconds silence_max);
    /// Closes a connection that was not opened yet.
    ~FedFrames() override;

    /// Takes over a feeder's connection, non-blocking, which it then closes. False: it has a feeder, and the
    /// connection stays the caller's. Any thread; does not wait.
    [[nodiscard]] bool take(int connection);
    /// The program that feeds it, for a person; empty: none. Any thread.
    [[nodiscard]] std::string feeder();

    [[nodiscard]] Result<std::unique_ptr<FrameStream>, std::string> open(int interrupt) override;
    [[nodiscard]] std::string why_at_first() const override { return device_ + ": no program feeds it"; }
    [[nodiscard]] std::string remedy() const override {
        return "start `octoskin bridge`, the program that feeds it; if it runs, `octoskin bridge status` "
               "says why no image comes";
    }
    [[nodiscard]] bool may_repeat() const override { return false; }

    /// The time of a frame that arrives now, both of CLOCK_MONOTONIC in microseconds, is not too old, nor in
    /// the future.
    [[nodiscard]] static bool is_timely(std::uint64_t timestamp_us, std::uint64_t now_us) noexcept;

  private:
    class Stream;
    /// The connection of the present feeder; -1: there is none.
    [[nodiscard]] int present() const;
    [[nodiscard]] int begin_feeding();
    void end_feeding();

    std::string device_;
    openni2::FrameSize size_;
    std::chrono::milliseconds silence_max_;
    WakeEvent given_;
    std::mutex mutex_;
    int feeding_ = -1;  ///< the connection of the stream; -1: there is none
    int waiting_ = -1;  ///< the connection of the next stream
};

}  // namespace octoskin
