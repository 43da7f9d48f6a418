#include "host/apps/daemon/watcher.hpp"

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
    }
    return false;
}

void Watcher::on_map(const MapNow& now, const watch::BrickCodes& changed) {
    if (!wants_.map) return;
    missing_.add(has_map_ ? changed : watch::bricks_of(now.map));
    has_map_ = true;
    is_behind_ = true;
}

void Watcher::on_event(const WatchEvent& event) {
    if (!wants_.has(event.kind)) return;
    events_.push_back(event);
    if (events_.size() <= kEventsMax) return;
    events_.pop_front();
    ++lost_;
}

std::string_view Watcher::pending(const MapNow* now) {
    if (sent_ == bytes_.size()) {
        bytes_.clear();
        sent_ = 0;
        put_events();
        if (now != nullptr && is_behind_) put_map(*now);
    }
    return std::string_view(bytes_).substr(sent_);
}

void Watcher::on_sent(std::size_t bytes) {
    sent_ += bytes;
}

void Watcher::put_events() {
    while (!events_.empty() && bytes_.size() < kChunkBytes) {
        const WatchEvent event = std::move(events_.front());
        events_.pop_front();
        put(event.kind, 0, event.time, *event.payload);
    }
}

void Watcher::put_map(const MapNow& now) {
    const std::string payload = missing_.take(now.map, kChunkBytes);
    is_behind_ = !missing_.empty();
    std::uint8_t flags = is_behind_ ? 0 : watch::kComplete;
    if (!std::exchange(has_begun_, true)) flags |= watch::kBegins;
    put(watch::FrameKind::map, flags, now.time, payload);
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
