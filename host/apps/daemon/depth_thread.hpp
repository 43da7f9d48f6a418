// The thread that turns depth frames into terms, so that no reading waits for an image.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "host/apps/daemon/wake_event.hpp"
#include "host/core/pipeline/depth_worker.hpp"

namespace octoskin {

class DepthThread final : public DepthWorker {
  public:
    /// Throws std::system_error if there is no thread or descriptor left.
    DepthThread();
    /// Waits for the work in progress.
    ~DepthThread() override;
    DepthThread(const DepthThread&) = delete;
    DepthThread& operator=(const DepthThread&) = delete;

    /// Readable when a piece of work is done, until `acknowledge`.
    [[nodiscard]] int descriptor() const noexcept { return event_.descriptor(); }
    void acknowledge() const noexcept { event_.clear(); }

    void begin(std::function<void()> work) override;
    [[nodiscard]] bool is_done() const override;
    void finish() override;

  private:
    void run();

    WakeEvent event_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::function<void()> work_;  ///< null: no work, or it is done
    std::exception_ptr thrown_;
    bool is_ending_ = false;
    std::thread thread_;  ///< the last member: it uses all others
};

}  // namespace octoskin
