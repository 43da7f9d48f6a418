// What systemd is told of this program, as sd_notify(3) has it: a library less on the board.
#pragma once

#include <optional>
#include <string>

#include "common/time.hpp"

namespace octoskin::linux_port {

/// Says nothing at all unless a service manager asked for it by NOTIFY_SOCKET. Never waits.
class ServiceManager {
  public:
    /// NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID of the environment.
    [[nodiscard]] static ServiceManager from_environment();
    /// `watchdog`: it takes a silence that long for a program that hangs; none: it does not.
    ServiceManager(std::string socket, std::optional<Microseconds> watchdog)
        : socket_(std::move(socket)), watchdog_(watchdog) {}

    /// The devices are there and the loop turns.
    void started() const { tell("READY=1"); }
    void stopping() const { tell("STOPPING=1"); }
    /// The loop has turned once more. Told on at most every quarter of the watchdog's time.
    void turned(NodeTime now);
    /// How long the loop may sleep: a quarter of the watchdog's time; empty: as long as it likes.
    [[nodiscard]] std::optional<Microseconds> sleep_max() const;

  private:
    void tell(const char* state) const;

    std::string socket_;  ///< of a Unix datagram socket; with '@' first an abstract one; empty: none
    std::optional<Microseconds> watchdog_;
    std::optional<NodeTime> told_;
};

}  // namespace octoskin::linux_port
