// The signals of a daemon while it begins: none may end it half-way, and none is lost.
#pragma once

#include <memory>

#include "host/apps/daemon/log_queue.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/daemon/wake_event.hpp"

namespace octoskin::app {

/// To be called first of all. From now on the signals that a daemon obeys wait for its loop, and those that
/// mean nothing to it are ignored; one that another part has taken already, as a profiler, is left alone.
void hold_daemon_signals();

/// Where the limit of the processor time (ulimit -t) is one that kills, it comes some seconds earlier as
/// SIGXCPU, so that the map can be saved.
void keep_processor_time_for_the_end();

/// While the daemon begins: SIGTERM, SIGINT and SIGQUIT wait for its loop, but if that has not begun within
/// kPatience, as on a file system that does not answer, they end the process: 128 and the signal's number.
class StartGuard {
  public:
    static constexpr int kPatienceMs = 5000;

    /// Throws std::system_error if there is no thread, or no descriptor, to be had.
    explicit StartGuard(std::shared_ptr<const LogQueue> log);
    ~StartGuard();
    StartGuard(const StartGuard&) = delete;
    StartGuard& operator=(const StartGuard&) = delete;

  private:
    void work() const;

    std::shared_ptr<const LogQueue> log_;
    WakeEvent has_begun_;
    int signals_;  ///< signalfd(2)
    std::thread thread_;
};

}  // namespace octoskin::app
