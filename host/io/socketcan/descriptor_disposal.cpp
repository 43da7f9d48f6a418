#include "host/io/socketcan/descriptor_disposal.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>

namespace octoskin::socketcan {
namespace {

class Disposal {
  public:
    void add(int descriptor) {
        const std::lock_guard lock(mutex_);
        waiting_.push_back(descriptor);
        ++closing_;
        if (waiting_.size() > resting_ && threads_ < kThreadsMax) start_thread();
        changed_.notify_one();
    }
    [[nodiscard]] std::size_t closing() {
        const std::lock_guard lock(mutex_);
        return closing_;
    }

  private:
    static constexpr std::size_t kThreadsMax = 4;

    /// Without one, what waits is closed once there is.
    void start_thread() {
        try {
            std::thread([this] { work(); }).detach();
            ++threads_;
        } catch (const std::system_error&) {
        }
    }
    void work() {
        std::unique_lock lock(mutex_);
        while (true) {  // as long as the process lives
            ++resting_;
            changed_.wait(lock, [this] { return !waiting_.empty(); });
            --resting_;
            const int descriptor = waiting_.front();
            waiting_.pop_front();
            lock.unlock();
            ::close(descriptor);
            lock.lock();
            --closing_;
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<int> waiting_;
    std::size_t closing_ = 0;  ///< those that wait, and those that a thread is at
    std::size_t threads_ = 0;
    std::size_t resting_ = 0;
};

/// Never destroyed: its threads go with the process.
Disposal& disposal() {
    static auto* const only = new Disposal;
    return *only;
}

}  // namespace

void close_beside(int descriptor) {
    // A connection need not linger: closing it then takes no time. No socket: nothing to do.
    const linger none{.l_onoff = 0, .l_linger = 0};
    (void)::setsockopt(descriptor, SOL_SOCKET, SO_LINGER, &none, sizeof(none));
    disposal().add(descriptor);
}

std::size_t closing() {
    return disposal().closing();
}

}  // namespace octoskin::socketcan
