// A depth frame that another thread turns into terms while readings go into the maps.
#pragma once

#include <memory>

#include "common/result.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/pipeline/depth_worker.hpp"
#include "host/core/pipeline/map_builder.hpp"

namespace octoskin {

/// At one frame at a time. While it is at one, the builder must not be moved.
class DepthBeside {
  public:
    /// `worker` lives as long as it is named here; null: none. Nothing is in work (asserted).
    void lend(DepthWorker* worker);
    [[nodiscard]] bool has_worker() const noexcept { return worker_ != nullptr; }
    [[nodiscard]] bool is_at_work() const noexcept { return work_ != nullptr; }
    /// Something is in work (asserted), and `finish` does not wait.
    [[nodiscard]] bool is_done() const { return worker_->is_done(); }

    /// Errors: those of MapBuilder::begin, or no_memory.
    [[nodiscard]] Status<DepthReason> begin(MapBuilder& builder, DepthFrame frame);
    /// Waits for the worker; what it made goes into the maps. Errors: those of MapBuilder::finish.
    [[nodiscard]] Status<DepthReason> finish(MapBuilder& builder);

  private:
    DepthWorker* worker_ = nullptr;
    std::unique_ptr<MapBuilder::DepthWork> work_;  ///< what the worker is at, or has done
};

}  // namespace octoskin
