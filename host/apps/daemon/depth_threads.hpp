// One DepthThread for each camera.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "host/apps/daemon/depth_thread.hpp"
#include "host/apps/daemon/event_loop.hpp"

namespace octoskin {

class DepthThreads {
  public:
    /// `on_done` is called in the loop when a thread has finished a piece of work. `loop` must outlive it.
    DepthThreads(EventLoop& loop, std::function<void()> on_done)
        : loop_(loop), on_done_(std::move(on_done)) {}

    /// At least so many threads; existing ones stay. Throws std::system_error if there is no thread or
    /// descriptor left: then there are as many as before.
    void grow_to(std::size_t count) {
        while (threads_.size() < count) threads_.push_back(begun());
    }
    /// All of them, one for each camera or more.
    [[nodiscard]] std::vector<DepthWorker*> workers() const {
        std::vector<DepthWorker*> workers;
        for (const Watched& watched : threads_) workers.push_back(watched.thread.get());
        return workers;
    }

  private:
    struct Watched {
        std::unique_ptr<DepthThread> thread;
        EventSource done;
    };
    [[nodiscard]] Watched begun() {
        auto thread = std::make_unique<DepthThread>();
        auto done = loop_.on_readable(thread->descriptor(), [this, thread = thread.get()] {
            thread->acknowledge();
            on_done_();
        });
        return {std::move(thread), std::move(done)};
    }

    EventLoop& loop_;
    std::function<void()> on_done_;
    std::vector<Watched> threads_;
};

}  // namespace octoskin
