// Lets another thread convert a depth frame to terms while readings go into the maps.
#pragma once

#include <memory>

#include "common/result.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/pipeline/depth_worker.hpp"
#include "host/core/pipeline/map_builder.hpp"

namespace octoskin {

/// Handles one frame at a time. The builder must not be moved meanwhile.
class DepthBeside {
  public:
    /// `worker` must live until it is replaced; null: none. No frame may be in work (asserted).
    void lend(DepthWorker* worker);
    [[nodiscard]] bool has_worker() const noexcept { return worker_ != nullptr; }
    [[nodiscard]] bool is_at_work() const noexcept { return work_ != nullptr; }
    /// A frame must be in work (asserted). True if `finish` will not wait.
    [[nodiscard]] bool is_done() const { return worker_->is_done(); }

    /// Errors: those of MapBuilder::begin, or no_memory.
    [[nodiscard]] Status<DepthReason> begin(MapBuilder& builder, DepthFrame frame);
    /// Waits for the worker and applies the terms to the maps. Errors: those of MapBuilder::finish.
    [[nodiscard]] Status<DepthReason> finish(MapBuilder& builder);

  private:
    DepthWorker* worker_ = nullptr;
    std::unique_ptr<MapBuilder::DepthWork> work_;  ///< the frame in work, or just done
};

}  // namespace octoskin
