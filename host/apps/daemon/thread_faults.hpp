// What ends a thread of the daemon, though nothing in that thread foresees it: most often there is no memory.
// The loop ends by it, in the ordinary way, and the map is saved.
#pragma once

#include <exception>

#include "host/apps/daemon/wake_event.hpp"

namespace octoskin {

/// For as long as it lives; there is one in a process at a time (asserted).
class ThreadFaults {
  public:
    /// Throws std::system_error if there is no descriptor to be had.
    ThreadFaults();
    ~ThreadFaults();
    ThreadFaults(const ThreadFaults&) = delete;
    ThreadFaults& operator=(const ThreadFaults&) = delete;

    /// Of what is thrown just now, from any thread's catch block. False: there is none of these to take it.
    [[nodiscard]] static bool tell() noexcept;

    /// Readable once a thread has ended so.
    [[nodiscard]] int descriptor() const noexcept { return event_.descriptor(); }
    /// Throws what the first of them threw; nothing if none has ended so.
    void rethrow();

  private:
    WakeEvent event_;
    std::exception_ptr first_;
};

}  // namespace octoskin
