// Plays a recording in a thread of its own: at any speed, from any of its times, as often as asked.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "common/time.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/wake_event.hpp"
#include "host/bridge/recorded/recorded_events.hpp"

namespace octoskin::view {

/// What is heard from a player, in the thread of the loop.
class PlayerListener : public bridge::DaemonListener {
  public:
    /// The recording ended, with an error or without.
    virtual void on_end(const std::optional<AppError>& error) = 0;
};

class RecordedPlayer {
  public:
    /// Events that wait for the loop; then the playback waits.
    static constexpr std::size_t kWaitingMax = 256;

    /// Plays at real time from the beginning. `loop` and `listener` must outlive it.
    RecordedPlayer(EventLoop& loop, bridge::RecordedEvents events, PlayerListener& listener);
    ~RecordedPlayer();
    RecordedPlayer(const RecordedPlayer&) = delete;
    RecordedPlayer& operator=(const RecordedPlayer&) = delete;

    /// The slowest playback that is not a pause.
    static constexpr double kSpeedMin = 0.001;
    /// Speed 0 pauses; else at least kSpeedMin. `at`: goes to this time of the bus; earlier than now: the
    /// recording begins anew, and what is before `at` passes as quickly as it can.
    void play(std::optional<HostTime> at, double speed);
    /// The time that was reached; empty: none yet.
    [[nodiscard]] std::optional<HostTime> now() const;
    [[nodiscard]] double speed() const;

  private:
    class Relay;
    struct Interrupted {};
    using Clock = std::chrono::steady_clock;
    /// A time of the recording and when it was played.
    struct Base {
        Clock::time_point played;
        HostTime time;
    };

    void work();
    [[nodiscard]] std::optional<AppError> play_once();
    /// Waits until this time is due. Throws Interrupted.
    void wait_for(HostTime time);
    /// Hands an event to the loop, and waits if too many wait there. Throws Interrupted.
    void post(std::function<void()> event);
    [[nodiscard]] bool is_passing() const;
    void throw_if_interrupted() const;
    void take_events();

    bridge::RecordedEvents events_;
    PlayerListener& listener_;
    WakeEvent wake_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::function<void()>> waiting_;
    double speed_ = 1.0;
    std::optional<Base> base_;
    std::optional<HostTime> passing_until_;  ///< what is earlier is not waited for
    std::optional<HostTime> now_;
    bool is_restarting_ = false;
    bool is_ending_ = false;
    std::exception_ptr thrown_;  ///< by the playback
    EventSource readable_;
    std::thread thread_;  ///< the last member: it uses all others
};

}  // namespace octoskin::view
