// Handles Ctrl-C and SIGTERM during a command that writes files: no partly written file remains.
#pragma once

#include <thread>

#include "host/apps/command_line/end_signals.hpp"

namespace octoskin::app {

class Interruption {
  public:
    /// While this object exists, SIGINT, SIGTERM and SIGHUP (the terminal was closed) remove the unfinished
    /// files (host/apps/recording/unfinished.hpp), print a message and end the process, whatever it is doing.
    /// The exit code is 128 and the signal's number: 130, 143, 129. A second signal ends the process at once.
    /// Must be constructed before other threads start. Throws std::system_error if no descriptor or thread
    /// can be made.
    Interruption();
    ~Interruption();
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

  private:
    void watch() const;

    EndSignals signals_{SIGINT, SIGTERM, SIGHUP};
    int ended_;  ///< readable when this object is being destroyed
    std::thread watcher_;
};

}  // namespace octoskin::app
