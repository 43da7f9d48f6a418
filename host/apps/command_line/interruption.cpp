#include "host/apps/command_line/interruption.hpp"

#include <poll.h>
#include <pthread.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <system_error>

#include "host/apps/recording/unfinished.hpp"

namespace octoskin::app {
namespace {

/// Runs in the thread that receives the signals: removing the files may block on a slow disk, and a second
/// signal must end the process all the same.
void let_the_next_one_kill() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

[[noreturn]] void end(int signal) {
    constexpr int kSignalled = 128;  // the convention of shells
    let_the_next_one_kill();
    const RemovedUnfinished removed = remove_unfinished();
    spdlog::warn("interrupted{}",
                 removed.is_any ? ": unfinished files are removed, files from before are unchanged" : "");
    ::_exit(kSignalled + signal);  // exit() would destroy objects that other threads still use
}

}  // namespace

Interruption::Interruption() : ended_(::eventfd(0, EFD_CLOEXEC)) {
    if (ended_ < 0) throw std::system_error(errno, std::generic_category(), "cannot make an eventfd");
    watcher_ = std::thread([this] { watch(); });
}

Interruption::~Interruption() {
    const std::uint64_t one = 1;
    while (::write(ended_, &one, sizeof(one)) < 0 && errno == EINTR) {
    }
    watcher_.join();
    ::close(ended_);
}

void Interruption::watch() const {
    while (true) {  // until the owner ends it
        std::array<pollfd, 2> ready{{{signals_.descriptor(), POLLIN, 0}, {ended_, POLLIN, 0}}};
        ::poll(ready.data(), ready.size(), -1);
        // First the signal: a helper process gets it, too, and its failure is then not to be reported.
        if (const auto signal = signals_.came(std::chrono::milliseconds(0))) end(*signal);
        if (ready[1].revents != 0) return;
    }
}

}  // namespace octoskin::app
