#include "host/apps/command_line/end_signals.hpp"

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>

namespace octoskin::app {

EndSignals::EndSignals(std::initializer_list<int> wanted) {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : wanted) {
        // A shell makes background commands ignore SIGINT, and a signalfd would receive it nevertheless:
        // leave ignored signals alone.
        struct sigaction found {};
        sigaction(signal, nullptr, &found);
        if (found.sa_handler != SIG_IGN) sigaddset(&signals, signal);
    }
    // First the descriptor: if it cannot be made, the signals must not stay blocked.
    descriptor_ = ::signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "cannot make a signalfd");
    sigprocmask(SIG_BLOCK, &signals, nullptr);
}

EndSignals::~EndSignals() {
    ::close(descriptor_);
}

std::optional<int> EndSignals::came(std::chrono::milliseconds patience) const {
    pollfd readable{descriptor_, POLLIN, 0};
    if (::poll(&readable, 1, static_cast<int>(patience.count())) != 1) return std::nullopt;
    signalfd_siginfo signal{};
    if (::read(descriptor_, &signal, sizeof(signal)) != sizeof(signal)) return std::nullopt;
    return static_cast<int>(signal.ssi_signo);
}

}  // namespace octoskin::app
