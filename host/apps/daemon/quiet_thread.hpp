// A thread that no signal is delivered to: signals are for the one that runs the event loop.
#pragma once

#include <pthread.h>

#include <csignal>
#include <thread>
#include <utility>

namespace octoskin {

template <class Work>
[[nodiscard]] std::thread start_without_signals(Work work) {
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    std::thread thread(std::move(work));
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    return thread;
}

}  // namespace octoskin
