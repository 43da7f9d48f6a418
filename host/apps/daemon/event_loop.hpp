// One thread that waits for many things: descriptors, times, signals. systemd's sd-event, as values.
#pragma once

#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <utility>

struct sd_event;
struct sd_event_source;

namespace octoskin {

/// What is watched for as long as it lives. Movable; an empty one watches nothing.
class EventSource {
  public:
    struct Watch {  ///< what sd-event calls back
        sd_event_source* source = nullptr;
        std::function<void()> call;
        class EventLoop* loop = nullptr;
        std::uint64_t period_us = 0;  ///< of a timer

        Watch() = default;
        Watch(const Watch&) = delete;
        Watch& operator=(const Watch&) = delete;
        ~Watch();
    };
    EventSource() = default;
    explicit EventSource(std::unique_ptr<Watch> watch) : watch_(std::move(watch)) {}

  private:
    std::unique_ptr<Watch> watch_;
};

class EventLoop {
  public:
    /// Throws std::system_error if the system has no room for it. The service manager's watchdog, if there
    /// is one, is fed as long as the loop turns.
    EventLoop();
    ~EventLoop();
    EventLoop(const EventLoop&) = delete;
    EventLoop& operator=(const EventLoop&) = delete;

    /// `on_ready` whenever there is something to read, or the other end is gone. The descriptor stays the
    /// caller's, and must outlive the source.
    [[nodiscard]] EventSource on_readable(int descriptor, std::function<void()> on_ready);
    /// The first time one period from now.
    [[nodiscard]] EventSource every(std::chrono::microseconds period, std::function<void()> on_time);
    /// Blocks the signal for this thread and those it starts from now on.
    [[nodiscard]] EventSource on_signal(int signal, std::function<void()> on_signal);

    /// Until `stop`; returns what it was given. Throws what a call threw, if one did.
    int run();
    /// Ends the loop: `run` will throw this.
    void fail(std::exception_ptr thrown);
    void stop(int outcome);

  private:
    sd_event* loop_ = nullptr;
    std::exception_ptr thrown_;
};

}  // namespace octoskin
