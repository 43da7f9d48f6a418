#include "host/apps/daemon/depth_thread.hpp"

#include <cassert>
#include <utility>

#include "host/apps/daemon/quiet_thread.hpp"

namespace octoskin {

DepthThread::DepthThread() : thread_(start_without_signals([this] { run(); })) {}

DepthThread::~DepthThread() {
    {
        const std::scoped_lock lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
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
    yield_to_the_loop();
    std::unique_lock lock(mutex_);
    while (true) {  // ends with the object
        changed_.wait(lock, [this] { return work_ || is_ending_; });
        if (!work_) return;
        lock.unlock();
        std::exception_ptr thrown;
        try {
            work_();  // no other thread touches it until it is null
        } catch (...) {
            thrown = std::current_exception();
        }
        lock.lock();
        thrown_ = thrown;
        work_ = nullptr;
        changed_.notify_all();
        event_.wake();
    }
}

}  // namespace octoskin
