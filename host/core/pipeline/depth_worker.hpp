// Interface to a thread that converts depth frames to terms while the pipeline processes readings.
#pragma once

#include <functional>

namespace octoskin {

/// A thread beside the pipeline's, with one task at a time.
class DepthWorker {
  public:
    virtual ~DepthWorker() = default;
    /// Begins the task and returns at once. The previous task must be finished (asserted).
    virtual void begin(std::function<void()> work) = 0;
    [[nodiscard]] virtual bool is_done() const = 0;
    /// Waits for the end of the task. Throws what the task threw.
    virtual void finish() = 0;
};

}  // namespace octoskin
