// One thread that waits for descriptors, times and signals: systemd's sd-event, as values.
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

/// A watch, which ends when this is destroyed. Movable; an empty one watches nothing.
class EventSource {
  public:
    struct Watch {  ///< the target of sd-event's callbacks
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
    /// Throws std::system_error if the system lacks resources. While the loop runs, it feeds the service
    /// manager's watchdog, if there is one.
    EventLoop();
    ~EventLoop();
    EventLoop(const EventLoop&) = delete;
    EventLoop& operator=(const EventLoop&) = delete;

    /// Calls `on_ready` whenever there is something to read, or the other end is gone. The descriptor still
    /// belongs to the caller, and must outlive the source.
    [[nodiscard]] EventSource on_readable(int descriptor, std::function<void()> on_ready);
    /// Calls `on_time` in each period, the first time one period from now.
    [[nodiscard]] EventSource every(std::chrono::microseconds period, std::function<void()> on_time);
    /// Blocks the signal for this thread and for those that it starts from now on.
    [[nodiscard]] EventSource on_signal(int signal, std::function<void()> on_signal);

    /// Runs until `stop`, and returns its argument. Throws the exception of a callback, if one threw.
    int run();
    /// For a program that waits in another loop: readable when `turn` has something to do. It belongs to this
    /// object, and reports nothing before the first `turn`.
    [[nodiscard]] int descriptor() const noexcept;
    enum class Turn : std::uint8_t { idle, more, over };
    /// Does what is due, without waiting: `more`: not all of it, so that others have their turn; `over`: it
    /// was ended by `stop`. Throws the exception of a callback, if one threw. Call it again after `idle` when
    /// `descriptor` is readable, and after `more` at once.
    [[nodiscard]] Turn turn();
    /// Ends the loop: `run` throws this exception.
    void fail(std::exception_ptr thrown);
    void stop(int outcome);

  private:
    sd_event* loop_ = nullptr;
    std::exception_ptr thrown_;
};

}  // namespace octoskin
