// Threads that work on the parts of one thing together.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace octoskin {

/// Who works is whoever calls `work`, and threads that wait for it in between. They are started by the first
/// call, so that they block the signals that its thread blocks.
class Crew {
  public:
    /// `size`: the caller included, at least 1 (asserted); of 1 everything is done by the caller.
    explicit Crew(unsigned size);
    ~Crew();
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;

    [[nodiscard]] unsigned size() const noexcept { return size_; }

    /// Calls part(0) to part(count - 1), each once, in any order and at the same time, and returns when all
    /// have ended. What one throws is thrown here again, the first of them; then parts that had not begun are
    /// left out. Not for two threads at once, nor from within a part. Where there are no threads to be had it
    /// makes do with fewer. Some 50 us beside the work, or 2 if the call before ended less than 0.2 ms ago:
    /// so long the threads stay awake.
    void work(std::size_t count, const std::function<void(std::size_t index)>& part);

  private:
    void start() noexcept;
    void run();
    void take_parts() noexcept;

    unsigned size_;
    std::vector<std::thread> others_;
    std::mutex mutex_;  // to write any of what is below, but `next_`
    std::condition_variable changed_;
    const std::function<void(std::size_t)>* part_ = nullptr;
    std::size_t count_ = 0;
    std::atomic<std::size_t> next_{0};
    std::atomic<std::uint64_t> round_{0};
    std::atomic<unsigned> busy_{0};  ///< of the others, in this round
    std::atomic<bool> is_ending_{false};
    std::exception_ptr thrown_;
};

}  // namespace octoskin
