#include "host/apps/octoskin/daemon_signals.hpp"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <initializer_list>
#include <system_error>
#include <thread>
#include <utility>

#include "host/io/socketcan/short_waits.hpp"

namespace octoskin::app {
namespace {

sigset_t set_of(std::initializer_list<int> signals) {
    sigset_t set;
    sigemptyset(&set);
    for (const int signal : signals) sigaddset(&set, signal);
    return set;
}

void ignore(int signal) {
    struct sigaction found {};
    if (::sigaction(signal, nullptr, &found) == 0 && found.sa_handler == SIG_DFL)
        std::signal(signal, SIG_IGN);
}

bool is_readable(int descriptor, int patience_ms) {
    pollfd watched{descriptor, POLLIN, 0};
    return ::poll(&watched, 1, patience_ms) > 0;
}

int open_signals() {
    const sigset_t ending = set_of({SIGTERM, SIGINT, SIGQUIT});
    const int descriptor = ::signalfd(-1, &ending, SFD_CLOEXEC);
    if (descriptor < 0) throw std::system_error(errno, std::generic_category(), "signalfd");
    return descriptor;
}

}  // namespace

void hold_daemon_signals() {
    const sigset_t obeyed = set_of({SIGTERM, SIGINT, SIGQUIT, SIGHUP, SIGXCPU});
    pthread_sigmask(SIG_BLOCK, &obeyed, nullptr);
    for (const int signal :
         {SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGIO, SIGPWR, SIGSTKFLT, SIGPIPE, SIGTRAP,
          SIGSYS})  // of the last two only signals that are sent: a fault of that kind ends the process
        ignore(signal);
    for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) ignore(signal);
    const sigset_t ours =
        set_of({socketcan::ShortWaits::signal()});  // one of another process would end calls early
    pthread_sigmask(SIG_BLOCK, &ours, nullptr);
}

void keep_processor_time_for_the_end() {
    constexpr rlim_t kForTheEnd_s = 5;
    rlimit limit{};
    if (::getrlimit(RLIMIT_CPU, &limit) != 0 || limit.rlim_max == RLIM_INFINITY) return;
    limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max - std::min(kForTheEnd_s, limit.rlim_max / 2));
    (void)::setrlimit(RLIMIT_CPU, &limit);
}

StartGuard::StartGuard(std::shared_ptr<const LogQueue> log) : log_(std::move(log)), signals_(open_signals()) {
    try {
        thread_ = start_without_signals([this] { work(); });
    } catch (...) {
        ::close(signals_);
        throw;
    }
}

StartGuard::~StartGuard() {
    has_begun_.wake();
    thread_.join();
    ::close(signals_);
}

void StartGuard::work() const {
    std::array<pollfd, 2> watched{pollfd{signals_, POLLIN, 0}, pollfd{has_begun_.descriptor(), POLLIN, 0}};
    while (::poll(watched.data(), watched.size(), -1) < 0) {  // interrupted
    }
    if (watched[1].revents != 0) return;
    // The signal stays pending for the loop, which takes it when it starts.
    if (is_readable(has_begun_.descriptor(), kPatienceMs)) return;
    signalfd_siginfo came{};
    if (::read(signals_, &came, sizeof(came)) != sizeof(came)) return;
    const int signal = static_cast<int>(came.ssi_signo);
    spdlog::error("ended by signal {} before it had begun: a file system that it needs does not answer",
                  signal);
    constexpr std::chrono::milliseconds kStep{10};
    for (auto waited = kStep; log_->record().waiting > 0 && waited < std::chrono::seconds{1}; waited += kStep)
        std::this_thread::sleep_for(kStep);
    ::_exit(128 + signal);
}

}  // namespace octoskin::app
