// The signals of a daemon during its start: none may end it in between, and none is lost.
#pragma once

#include <memory>

#include "host/apps/daemon/log_queue.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/daemon/wake_event.hpp"

namespace octoskin::app {

/// Call this first. From now on the signals that a daemon obeys wait for its loop, and those without meaning
/// for it are ignored. One that another part handles already, such as a profiler, is left alone.
void hold_daemon_signals();

/// If the processor time limit (ulimit -t) would kill the process, SIGXCPU arrives some seconds earlier, so
/// that the map can be saved.
void keep_processor_time_for_the_end();

/// During the start SIGTERM, SIGINT and SIGQUIT wait for the daemon's loop. If that has not started within
/// kPatience, as on a file system that does not answer, they end the process with exit code 128 plus the
/// signal's number.
class StartGuard {
  public:
    static constexpr int kPatienceMs = 5000;

    /// Throws std::system_error if there is no thread or descriptor left.
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
