#include "host/apps/daemon/event_loop.hpp"

#include <sys/epoll.h>
#include <systemd/sd-event.h>

#include <algorithm>
#include <csignal>
#include <system_error>
#include <utility>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin {

EventSource::Watch::~Watch() {
    if (source != nullptr) sd_event_source_disable_unref(source);
}

namespace {

void check(int result, const char* doing) {
    if (result < 0) throw std::system_error(-result, std::generic_category(), doing);
}

/// The callback may end its own watch, so a copy of it is called.
int call_copy(const void* watch) {
    const std::function<void()> call = static_cast<const EventSource::Watch*>(watch)->call;
    EventLoop& loop = *static_cast<const EventSource::Watch*>(watch)->loop;
    try {
        call();
    } catch (...) {  // must not cross the frames of a C library
        loop.fail(std::current_exception());
    }
    return 0;
}

int call_ready(sd_event_source*, int, std::uint32_t, void* watch) {
    return call_copy(watch);
}

int call_timer(sd_event_source* source, std::uint64_t due_us, void* given) {
    auto* watch = static_cast<EventSource::Watch*>(given);
    std::uint64_t now_us = 0;
    sd_event_now(sd_event_source_get_event(source), CLOCK_MONOTONIC, &now_us);
    // Missed periods are skipped.
    const std::uint64_t next_us = std::max(due_us, now_us - watch->period_us) + watch->period_us;
    sd_event_source_set_time(source, next_us);
    return call_copy(watch);
}

int call_signal(sd_event_source*, const signalfd_siginfo*, void* watch) {
    return call_copy(watch);
}

}  // namespace

EventLoop::EventLoop() {
    check(sd_event_new(&loop_), "cannot make an event loop");
    (void)sd_event_set_watchdog(loop_, 1);  // 0: there is no watchdog
}

EventLoop::~EventLoop() {
    sd_event_unref(loop_);
}

EventSource EventLoop::on_readable(int descriptor, std::function<void()> on_ready) {
    auto watch = std::make_unique<EventSource::Watch>();
    watch->call = std::move(on_ready);
    watch->loop = this;
    check(sd_event_add_io(loop_, &watch->source, descriptor, EPOLLIN, call_ready, watch.get()),
          "cannot watch a descriptor");
    return EventSource(std::move(watch));
}

EventSource EventLoop::every(std::chrono::microseconds period, std::function<void()> on_time) {
    constexpr std::uint64_t kAccuracyUs = 1'000;
    auto watch = std::make_unique<EventSource::Watch>();
    watch->call = std::move(on_time);
    watch->loop = this;
    watch->period_us = static_cast<std::uint64_t>(period.count());
    const auto first_us = static_cast<std::uint64_t>(monotonic_now().ns / 1000) + watch->period_us;
    check(sd_event_add_time(loop_, &watch->source, CLOCK_MONOTONIC, first_us, kAccuracyUs, call_timer,
                            watch.get()),
          "cannot set a timer");
    check(sd_event_source_set_enabled(watch->source, SD_EVENT_ON), "cannot start a timer");
    return EventSource(std::move(watch));
}

EventSource EventLoop::on_signal(int signal, std::function<void()> on_signal) {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, signal);
    check(-pthread_sigmask(SIG_BLOCK, &signals, nullptr), "cannot block a signal");
    auto watch = std::make_unique<EventSource::Watch>();
    watch->call = std::move(on_signal);
    watch->loop = this;
    check(sd_event_add_signal(loop_, &watch->source, signal, call_signal, watch.get()),
          "cannot watch a signal");
    return EventSource(std::move(watch));
}

int EventLoop::run() {
    const int outcome = sd_event_loop(loop_);
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    check(outcome < 0 ? outcome : 0, "the event loop failed");
    return outcome;
}

int EventLoop::descriptor() const noexcept {
    return sd_event_get_fd(loop_);
}

EventLoop::Turn EventLoop::turn() {
    constexpr int kCallsMax = 16;
    for (int i = 0; i < kCallsMax; ++i) {
        const int done = sd_event_run(loop_, 0);
        if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
        check(done, "the event loop failed");
        if (sd_event_get_state(loop_) == SD_EVENT_FINISHED) return Turn::over;
        if (done == 0) return Turn::idle;  // its timers are set
    }
    return Turn::more;
}

void EventLoop::fail(std::exception_ptr thrown) {
    thrown_ = std::move(thrown);
    (void)sd_event_exit(loop_, 1);
}

void EventLoop::stop(int outcome) {
    check(sd_event_exit(loop_, outcome), "cannot end the event loop");
}

}  // namespace octoskin
