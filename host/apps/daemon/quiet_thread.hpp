// A thread that gets no signals except its own faults: signals are for the thread of the event loop.
#pragma once

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <exception>
#include <future>
#include <thread>
#include <utility>

#include "common/time.hpp"
#include "host/apps/daemon/thread_faults.hpp"

namespace octoskin {

/// An exception of the work ends the daemon's loop (ThreadFaults) or, without one, the process.
template <class Work>
[[nodiscard]] std::thread start_without_signals(Work work) {
    sigset_t others;
    sigset_t before;
    sigfillset(&others);
    // A fault whose signal is blocked ends the process at once, and the waiting log lines would be lost.
    for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) sigdelset(&others, fault);
    pthread_sigmask(SIG_SETMASK, &others, &before);
    struct Restored {
        const sigset_t& mask;
        ~Restored() { pthread_sigmask(SIG_SETMASK, &mask, nullptr); }
    } const restored{before};
    return std::thread([work = std::move(work)]() mutable {
        try {
            work();
        } catch (const std::exception&) {
            if (!ThreadFaults::tell()) throw;
        }
    });
}

/// Gives this thread less of a busy processor than the loop, for which readings wait. `nicer`: 1 to 19, the
/// more the less.
inline void yield_to_the_loop(int nicer = 5) noexcept {
    (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), nicer);
}

/// `start_without_signals` for work that a disk may block in a write: the wait for its end is limited. So the
/// work must own all data that it uses.
class LeavableThread {
  public:
    template <class Work>
    explicit LeavableThread(Work work) {
        std::promise<void> ended;
        ended_ = ended.get_future();
        thread_ = start_without_signals([work = std::move(work), ended = std::move(ended)]() mutable {
            try {
                work();
            } catch (...) {  // a broken promise would need memory for its error
                ended.set_value();
                throw;
            }
            ended.set_value();
        });
    }
    ~LeavableThread() { (void)end(Nanoseconds{0}); }
    LeavableThread(const LeavableThread&) = delete;
    LeavableThread& operator=(const LeavableThread&) = delete;

    /// Waits at most `patience` for its end. False: it is left behind.
    bool end(Nanoseconds patience) {
        if (!thread_.joinable()) return true;
        const bool has_ended = ended_.wait_for(patience) == std::future_status::ready;
        if (has_ended) {
            ended_.get();
            thread_.join();
        } else {
            thread_.detach();
            was_left_ = true;
        }
        return has_ended;
    }

    /// Whether a thread was ever left behind. The process must then end by _exit(2): such a thread may still
    /// use objects that exit(3) destroys.
    [[nodiscard]] static bool was_one_left() noexcept { return was_left_; }

  private:
    static inline std::atomic<bool> was_left_ = false;

    std::future<void> ended_;
    std::thread thread_;
};

}  // namespace octoskin
