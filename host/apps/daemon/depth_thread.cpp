#include "host/apps/daemon/depth_thread.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <system_error>
#include <utility>

#include "host/apps/daemon/quiet_thread.hpp"

namespace octoskin {

DepthThread::DepthThread() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (event_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
    try {
        thread_ = start_without_signals([this] { run(); });
    } catch (...) {
        ::close(event_);
        throw;
    }
}

DepthThread::~DepthThread() {
    {
        const std::scoped_lock lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
    ::close(event_);
}

void DepthThread::acknowledge() const noexcept {
    eventfd_t count = 0;
    (void)::eventfd_read(event_, &count);
}

void DepthThread::begin(std::function<void()> work) {
    {
        const std::scoped_lock lock(mutex_);
        assert(!work_ && !thrown_);
        work_ = std::move(work);
    }
    changed_.notify_all();
}

bool DepthThread::is_done() const {
    const std::scoped_lock lock(mutex_);
    return !work_;
}

void DepthThread::finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !work_; });
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void DepthThread::run() {
    std::unique_lock lock(mutex_);
    while (true) {  // ends with the object
        changed_.wait(lock, [this] { return work_ || is_ending_; });
        if (!work_) return;
        lock.unlock();
        std::exception_ptr thrown;
        try {
            work_();  // nobody else touches it until it is null
        } catch (...) {
            thrown = std::current_exception();
        }
        lock.lock();
        thrown_ = thrown;
        work_ = nullptr;
        changed_.notify_all();
        (void)::eventfd_write(event_, 1);
    }
}

}  // namespace octoskin
