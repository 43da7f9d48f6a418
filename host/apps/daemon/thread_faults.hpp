// Unexpected exceptions in the daemon's threads, mostly for lack of memory. They end the loop in the ordinary
// way, and the map is saved.
#pragma once

#include <exception>

#include "host/apps/daemon/wake_event.hpp"

namespace octoskin {

/// Active while it lives; at most one in a process at a time (asserted).
class ThreadFaults {
  public:
    /// Throws std::system_error if there is no descriptor left.
    ThreadFaults();
    ~ThreadFaults();
    ThreadFaults(const ThreadFaults&) = delete;
    ThreadFaults& operator=(const ThreadFaults&) = delete;

    /// Reports the current exception; to be called in a catch block of any thread. False: there is no
    /// ThreadFaults.
    [[nodiscard]] static bool tell() noexcept;

    /// Readable once a thread has reported an exception.
    [[nodiscard]] int descriptor() const noexcept { return event_.descriptor(); }
    /// Throws the first of these exceptions; does nothing if there is none.
    void rethrow();

  private:
    WakeEvent event_;
    std::exception_ptr first_;
};

}  // namespace octoskin
