#include "hw/sim/experiment/sync_master.hpp"

#include <utility>

#include "common/wire/codec.hpp"

namespace octoskin::sim {
namespace {

std::uint64_t whole_us(HostTime time) {
    return static_cast<std::uint64_t>(time.ns / 1000);
}

}  // namespace

std::vector<wire::CanFrame> SyncMaster::poll(SimTime now) {
    if (now >= next_sync_) {
        sequence_ = static_cast<std::uint8_t>((sequence_ + 1U) % wire::kSyncSequenceCount);
        queue_.push_back(wire::encode(wire::Sync{sequence_}, wire::kHostId));
        next_sync_.us += sync_period_.count();
    }
    return std::exchange(queue_, {});
}

void SyncMaster::on_frame(const wire::CanFrame& frame, SimTime end) {
    if (frame.can_id != wire::can_id(wire::FrameType::sync, wire::kHostId)) return;
    queue_.push_back(wire::encode(wire::FollowUp{sequence_, whole_us(clock_.at(end))}, wire::kHostId));
}

void SyncMaster::mark(wire::MarkKind kind, SimTime at) {
    queue_.push_back(wire::encode(wire::Mark{kind, whole_us(clock_.at(at))}, wire::kHostId));
}

}  // namespace octoskin::sim
