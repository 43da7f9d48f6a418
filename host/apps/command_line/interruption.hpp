// Ctrl-C and SIGTERM in the midst of a command that writes files: it leaves none of them by halves.
#pragma once

#include <thread>

#include "host/apps/command_line/end_signals.hpp"

namespace octoskin::app {

class Interruption {
  public:
    /// While it lives SIGINT, SIGTERM and SIGHUP (a terminal that was closed) remove what is unfinished
    /// (host/apps/recording/unfinished.hpp), say so and end the process with 128 and the signal's number,
    /// wherever it is: 130, 143, 129. A second one ends it at once. To be made before other threads. Throws
    /// std::system_error without a descriptor or a thread.
    Interruption();
    ~Interruption();
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

  private:
    void watch() const;

    EndSignals signals_{SIGINT, SIGTERM, SIGHUP};
    int ended_;  ///< readable once there is nothing more to watch over
    std::thread watcher_;
};

}  // namespace octoskin::app
