// Work that may wait for a disk, in a thread beside the event loop, which takes the result.
#pragma once

#include <cassert>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "common/time.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/daemon/wake_event.hpp"

namespace octoskin {

/// One piece of work at a time. All calls from one thread, the loop's.
template <class Outcome>
class SideTask {
  public:
    /// It must own the data that it uses: it may outlive the task.
    using Work = std::function<Outcome()>;

    /// Throws std::system_error if there is no thread or descriptor left.
    SideTask() : thread_([shared = shared_] { run(*shared); }) {}
    /// Takes at most `kEndPatience`: work that hangs is left behind.
    ~SideTask() {
        {
            const std::lock_guard lock(shared_->mutex);
            shared_->is_ending = true;
        }
        shared_->changed.notify_all();
        (void)thread_.end(kEndPatience);
    }
    SideTask(const SideTask&) = delete;
    SideTask& operator=(const SideTask&) = delete;

    /// Readable while there is a result to take.
    [[nodiscard]] int descriptor() const noexcept { return shared_->done.descriptor(); }
    /// When the work began that is running, or whose result was not taken yet; empty: none.
    [[nodiscard]] const std::optional<HostTime>& begun() const noexcept { return begun_; }

    /// Asserted: no work is running, and the last result was taken.
    void begin(Work work) {
        assert(!begun_);
        begun_ = monotonic_now();
        {
            const std::lock_guard lock(shared_->mutex);
            shared_->work = std::move(work);
        }
        shared_->changed.notify_all();
    }
    /// The result of the work, once; empty: it has not ended. Throws the exception of the work.
    [[nodiscard]] std::optional<Outcome> take() { return wait(Nanoseconds{0}); }
    /// The same, waiting at most `patience` for the end of the work.
    [[nodiscard]] std::optional<Outcome> wait(Nanoseconds patience) {
        if (!begun_) return std::nullopt;
        std::unique_lock lock(shared_->mutex);
        const auto has_ended = [this] { return shared_->outcome || shared_->thrown; };
        if (!shared_->changed.wait_for(lock, patience, has_ended)) return std::nullopt;
        begun_.reset();
        shared_->done.clear();
        if (shared_->thrown) std::rethrow_exception(std::exchange(shared_->thrown, nullptr));
        return std::exchange(shared_->outcome, std::nullopt);
    }

  private:
    static constexpr Nanoseconds kEndPatience{100'000'000};

    struct Shared {
        std::mutex mutex;
        std::condition_variable changed;
        Work work;  ///< waits for the thread
        std::optional<Outcome> outcome;
        std::exception_ptr thrown;
        bool is_ending = false;
        WakeEvent done;
    };

    static void run(Shared& shared) {
        std::unique_lock lock(shared.mutex);
        while (true) {  // until the end
            shared.changed.wait(lock, [&shared] { return shared.work || shared.is_ending; });
            if (!shared.work) return;
            Work work = std::exchange(shared.work, nullptr);
            lock.unlock();
            std::optional<Outcome> outcome;
            std::exception_ptr thrown;
            try {
                outcome.emplace(work());
                work = nullptr;  // its data is released here, which may take long
            } catch (...) {
                thrown = std::current_exception();
            }
            lock.lock();
            shared.outcome = std::move(outcome);
            shared.thrown = std::move(thrown);
            shared.done.wake();
            shared.changed.notify_all();
        }
    }

    std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
    std::optional<HostTime> begun_;
    LeavableThread thread_;
};

}  // namespace octoskin
