#include "firmware/port/linux/service_manager.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace octoskin::linux_port {
namespace {

constexpr int kTellsPerWatchdog = 4;

std::string_view environment(const char* name) {
    const char* const text = std::getenv(name);
    return text == nullptr ? std::string_view() : std::string_view(text);
}

std::optional<std::int64_t> positive_number(std::string_view text) {
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || number <= 0) return std::nullopt;
    return number;
}

/// Ignored if WATCHDOG_PID names another process: child processes inherit the variables, but not the duty.
std::optional<Microseconds> watchdog_of_environment() {
    constexpr std::int64_t kMax_us = 600'000'000;  // 10 min; the node's clock wraps after 71 minutes
    const auto process = environment("WATCHDOG_PID");
    if (!process.empty() && positive_number(process) != ::getpid()) return std::nullopt;
    const auto time_us = positive_number(environment("WATCHDOG_USEC"));
    if (!time_us || *time_us > kMax_us) return std::nullopt;
    return Microseconds{*time_us};
}

}  // namespace

ServiceManager ServiceManager::from_environment() {
    return {std::string(environment("NOTIFY_SOCKET")), watchdog_of_environment()};
}

std::optional<Microseconds> ServiceManager::sleep_max() const {
    if (!watchdog_) return std::nullopt;
    return *watchdog_ / kTellsPerWatchdog;
}

void ServiceManager::turned(NodeTime now) {
    if (!watchdog_ || (reported_ && elapsed(*reported_, now) < *watchdog_ / kTellsPerWatchdog)) return;
    reported_ = now;
    tell("WATCHDOG=1");
}

void ServiceManager::tell(const char* state) const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (socket_.empty() || socket_.size() >= sizeof(address.sun_path)) return;
    std::memcpy(address.sun_path, socket_.data(), socket_.size());
    if (socket_.front() == '@') address.sun_path[0] = '\0';
    const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (descriptor < 0) return;
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
    // A lost datagram is followed by three more within the watchdog's time.
    (void)::sendto(descriptor, state, std::strlen(state), MSG_NOSIGNAL,
                   reinterpret_cast<const sockaddr*>(&address), size);
    ::close(descriptor);
}

}  // namespace octoskin::linux_port
