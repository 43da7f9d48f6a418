// Reports the program's state to systemd, as sd_notify(3) does, without the library.
#pragma once

#include <optional>
#include <string>

#include "common/time.hpp"

namespace octoskin::linux_port {

/// Sends nothing unless a service manager set NOTIFY_SOCKET. Never waits.
class ServiceManager {
  public:
    /// From NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID of the environment.
    [[nodiscard]] static ServiceManager from_environment();
    /// `watchdog`: without a report for this time, the service manager treats the program as hung; empty: no
    /// watchdog.
    ServiceManager(std::string socket, std::optional<Microseconds> watchdog)
        : socket_(std::move(socket)), watchdog_(watchdog) {}

    /// Reports that the devices are open and the loop runs.
    void started() const { tell("READY=1"); }
    void stopping() const { tell("STOPPING=1"); }
    /// Call once per turn of the loop. Reports at most once per quarter of the watchdog's time.
    void turned(NodeTime now);
    /// Longest time for which the loop may sleep: a quarter of the watchdog's time; empty: no limit.
    [[nodiscard]] std::optional<Microseconds> sleep_max() const;

  private:
    void tell(const char* state) const;

    std::string
        socket_;  ///< path of a Unix datagram socket; first character '@': an abstract one; empty: none
    std::optional<Microseconds> watchdog_;
    std::optional<NodeTime> reported_;
};

}  // namespace octoskin::linux_port
