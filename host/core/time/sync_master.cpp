#include "host/core/time/sync_master.hpp"

#include <utility>

namespace octoskin {

void SyncMaster::go_on() {
    sequence_ = static_cast<std::uint8_t>((sequence_ + 1U) % wire::kSyncSequenceCount);
}

std::optional<wire::Sync> SyncMaster::poll(HostTime now) {
    if (now < due_) return std::nullopt;
    is_hastened_ = due_ == early();
    due_ = now + period_;
    newest_ = now;
    go_on();
    is_awaited_ = true;
    return wire::Sync{sequence_};
}

void SyncMaster::hasten() noexcept {
    if (is_hastened_ || early() >= due_) return;
    due_ = early();
    is_hastened_ = true;
}

std::optional<wire::Sync> SyncMaster::poll_alone(HostTime now) {
    if (!is_awaited_ || now < newest_ + period_ / 2) return std::nullopt;
    is_awaited_ = false;
    go_on();
    return wire::Sync{sequence_};
}

std::optional<wire::FollowUp> SyncMaster::on_sent(std::uint8_t sequence, HostTime ended) {
    if (sequence != sequence_ || !std::exchange(is_awaited_, false)) return std::nullopt;
    return wire::FollowUp{sequence, static_cast<std::uint64_t>(ended.ns / 1000)};
}

}  // namespace octoskin
