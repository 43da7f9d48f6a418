#include "host/io/socketcan/short_waits.hpp"

#include <unistd.h>

#include <csignal>
#include <ctime>

namespace octoskin::socketcan {
namespace {

/// The signal repeats: the first may come before the call begins to wait.
constexpr long kPeriodNs = 1'000'000;

sigset_t just_ours() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, ShortWaits::signal());
    return set;
}

bool take_signal() {
    struct sigaction nothing {};
    nothing.sa_handler = [](int) {};
    nothing.sa_flags = SA_RESTART;
    return ::sigaction(ShortWaits::signal(), &nothing, nullptr) == 0;
}

/// Belongs to one thread, for that thread's lifetime.
class Timer {
  public:
    Timer() {
        static const bool has_signal = take_signal();
        sigevent event{};
        event.sigev_notify = SIGEV_THREAD_ID;
        event.sigev_signo = ShortWaits::signal();
        event._sigev_un._tid = ::gettid();  // glibc has no other name for this field
        is_made_ = has_signal && ::timer_create(CLOCK_MONOTONIC, &event, &timer_) == 0;
    }
    ~Timer() {
        if (is_made_) ::timer_delete(timer_);
    }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

    void set(long period_ns) const {
        const itimerspec every{.it_interval = {0, period_ns}, .it_value = {0, period_ns}};
        if (is_made_) (void)::timer_settime(timer_, 0, &every, nullptr);
    }

  private:
    timer_t timer_{};
    bool is_made_ = false;
};

thread_local const Timer timer_of_thread;
/// The thread's previous signal mask.
thread_local sigset_t mask_before;

}  // namespace

int ShortWaits::signal() noexcept {
    return SIGRTMAX - 1;
}

ShortWaits::ShortWaits() {
    timer_of_thread.set(kPeriodNs);  // installs the signal's handler at the first call
    const sigset_t ours = just_ours();
    pthread_sigmask(SIG_UNBLOCK, &ours, &mask_before);
}

ShortWaits::~ShortWaits() {
    timer_of_thread.set(0);
    pthread_sigmask(SIG_SETMASK, &mask_before, nullptr);
}

}  // namespace octoskin::socketcan
