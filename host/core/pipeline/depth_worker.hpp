// Who turns a depth frame into terms while the pipeline goes on with readings.
#pragma once

#include <functional>

namespace octoskin {

/// A thread beside the pipeline's, with one piece of work at a time.
class DepthWorker {
  public:
    virtual ~DepthWorker() = default;
    /// Begins with it and returns at once. What came before is finished (asserted).
    virtual void begin(std::function<void()> work) = 0;
    [[nodiscard]] virtual bool is_done() const = 0;
    /// Waits for the end. Throws what the work threw.
    virtual void finish() = 0;
};

}  // namespace octoskin
