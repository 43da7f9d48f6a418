#include "host/core/parallel/thread_pool.hpp"

#include <cassert>
#include <chrono>
#include <exception>
#include <utility>

namespace octoskin {
namespace {

/// Polls the condition for up to 200 us and yields to other threads. Waking a sleeping thread takes 30 to 100
/// us, as long as many a round lasts; the next round of an image begins sooner than that.
template <class IsSo>
void expect(const IsSo& is_so) {
    constexpr std::chrono::microseconds kAwake{200};
    const auto end = std::chrono::steady_clock::now() + kAwake;
    while (!is_so() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
}

}  // namespace

ThreadPool::ThreadPool(unsigned size) : size_(size) {
    assert(size >= 1);
}

ThreadPool::~ThreadPool() {
    {
        const std::scoped_lock lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_all();
    for (std::thread& other : others_) other.join();
}

void ThreadPool::start() noexcept {
    try {
        while (others_.size() + 1 < size_) others_.emplace_back([this] { run(); });
    } catch (const std::exception&) {  // no thread or no memory: the pool works with those it has
        size_ = static_cast<unsigned>(others_.size()) + 1;
    }
}

void ThreadPool::work(std::size_t count, const std::function<void(std::size_t)>& part) {
    if (size_ == 1 || count <= 1) {
        for (std::size_t i = 0; i < count; ++i) part(i);
        return;
    }
    start();
    {
        const std::scoped_lock lock(mutex_);
        assert(part_ == nullptr);
        part_ = &part;
        count_ = count;
        next_ = 0;
        busy_ = static_cast<unsigned>(others_.size());
        ++round_;
    }
    changed_.notify_all();
    take_parts();
    expect([this] { return busy_ == 0; });
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return busy_ == 0; });
    part_ = nullptr;
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void ThreadPool::take_parts() noexcept {
    for (std::size_t index = next_++; index < count_; index = next_++) {
        try {
            (*part_)(index);
        } catch (...) {  // an exception must not leave its thread
            const std::scoped_lock lock(mutex_);
            if (!thrown_) thrown_ = std::current_exception();
            next_ = count_;
        }
    }
}

void ThreadPool::run() {
    std::uint64_t round = 0;
    std::unique_lock lock(mutex_, std::defer_lock);
    while (true) {  // ends with the object
        expect([&] { return round_ != round || is_ending_; });
        lock.lock();
        changed_.wait(lock, [&] { return round_ != round || is_ending_; });
        if (is_ending_) return;
        round = round_;
        lock.unlock();
        take_parts();
        lock.lock();
        if (--busy_ == 0) changed_.notify_all();
        lock.unlock();
    }
}

}  // namespace octoskin
