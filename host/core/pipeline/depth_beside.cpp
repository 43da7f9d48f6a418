#include "host/core/pipeline/depth_beside.hpp"

#include <cassert>
#include <new>
#include <utility>

namespace octoskin {

void DepthBeside::lend(DepthWorker* worker) {
    assert(!work_);
    worker_ = worker;
}

Status<DepthReason> DepthBeside::begin(MapBuilder& builder, DepthFrame frame) {
    try {
        auto begun = builder.begin(std::move(frame));
        if (!begun) return unexpected(begun.error());
        work_ = std::make_unique<MapBuilder::DepthWork>(std::move(begun).value());
        worker_->begin([&builder, work = work_.get()] { builder.work(*work); });
        return Done{};
    } catch (const std::bad_alloc&) {
        work_ = nullptr;
        return unexpected(DepthReason::no_memory);
    }
}

Status<DepthReason> DepthBeside::finish(MapBuilder& builder) {
    const auto done = std::exchange(work_, nullptr);
    worker_->finish();
    return builder.finish(*done);
}

}  // namespace octoskin
