#include "host/apps/daemon/thread_faults.hpp"

#include <cassert>
#include <mutex>
#include <utility>

namespace octoskin {
namespace {

/// A thread that was left behind may end after the daemon.
std::mutex mutex;
ThreadFaults* there = nullptr;

}  // namespace

ThreadFaults::ThreadFaults() {
    const std::scoped_lock lock(mutex);
    assert(there == nullptr);
    there = this;
}

ThreadFaults::~ThreadFaults() {
    const std::scoped_lock lock(mutex);
    there = nullptr;
}

bool ThreadFaults::tell() noexcept {
    const std::scoped_lock lock(mutex);
    if (there == nullptr) return false;
    if (!there->first_) there->first_ = std::current_exception();
    there->event_.wake();
    return true;
}

void ThreadFaults::rethrow() {
    std::exception_ptr first;
    {
        const std::scoped_lock lock(mutex);
        event_.clear();
        first = std::exchange(first_, nullptr);
    }
    if (first) std::rethrow_exception(first);
}

}  // namespace octoskin
