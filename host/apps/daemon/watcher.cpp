#include "host/apps/daemon/watcher.hpp"

#include <algorithm>
#include <utility>

namespace octoskin {

bool WatchWants::has(watch::FrameKind kind) const noexcept {
    switch (kind) {
        case watch::FrameKind::map:
            return map;
        case watch::FrameKind::range:
            return ranges;
        case watch::FrameKind::joints:
            return joints;
        case watch::FrameKind::status:
            return status;
        case watch::FrameKind::image:
            return images;
        case watch::FrameKind::robot:
            return robot;
        case watch::FrameKind::reload:
            return true;
    }
    return false;
}

void Watcher::on_map(const MapNow& now, const watch::BrickCodes& changed) {
    if (wants_.map) map_.on_map(now.map, changed);
}

void Watcher::on_event(const WatchEvent& event) {
    if (!wants_.has(event.kind)) return;
    events_.push_back(event);
    if (event.kind == watch::FrameKind::reload) {
        ++reloads_waiting_;
        map_.wait_for_next();
    }
    if (events_.size() > kEventsMax) drop_oldest();
}

void Watcher::drop_oldest() {
    WatchEvent oldest = std::move(events_.front());
    events_.pop_front();
    if (!watch::is_lasting(oldest.kind)) {
        ++lost_;
        return;
    }
    const auto older = std::ranges::find(overdue_, oldest.kind, &WatchEvent::kind);
    if (older != overdue_.end()) {
        if (older->kind == watch::FrameKind::reload) --reloads_waiting_;
        overdue_.erase(older);
    }
    overdue_.push_back(std::move(oldest));
}

std::string_view Watcher::pending(const MapNow* now) {
    if (sent_ == bytes_.size()) {
        bytes_.clear();
        sent_ = 0;
        put_events();
        const bool may_follow = now != nullptr && reloads_waiting_ == 0;
        const auto piece = may_follow ? map_.next(now->map, kChunkBytes, now->changed) : std::nullopt;
        if (piece) put(watch::FrameKind::map, piece->flags, now->time, piece->payload);
    }
    return std::string_view(bytes_).substr(sent_);
}

void Watcher::on_sent(std::size_t bytes) {
    sent_ += bytes;
}

void Watcher::put_events() {
    for (const WatchEvent& event : overdue_) put(event);
    overdue_.clear();
    while (!events_.empty() && bytes_.size() < kChunkBytes) {
        const WatchEvent event = std::move(events_.front());
        events_.pop_front();
        put(event);
    }
}

void Watcher::put(const WatchEvent& event) {
    put(event.kind, 0, event.time, *event.payload);
    if (event.kind == watch::FrameKind::reload) --reloads_waiting_;
}

void Watcher::put(watch::FrameKind kind, std::uint8_t flags, HostTime time, std::string_view payload) {
    watch::put_header(bytes_, {.bytes = static_cast<std::uint32_t>(payload.size()),
                               .kind = kind,
                               .flags = flags,
                               .number = number_++,
                               .time = time,
                               .lost = lost_});
    bytes_ += payload;
}

}  // namespace octoskin
