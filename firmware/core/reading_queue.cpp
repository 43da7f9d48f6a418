#include "firmware/core/reading_queue.hpp"

#include <algorithm>
#include <cassert>

namespace octoskin::node {

ReadingQueue::ReadingQueue(bool uses_can_fd, std::uint8_t aux_every, const Policy& policy) noexcept
    : uses_can_fd_(uses_can_fd), aux_every_(aux_every), policy_(policy) {}

void ReadingQueue::push(std::uint8_t sensor, const Reading& reading, NodeTime now) noexcept {
    const auto end = queue_.begin() + waiting_;
    const auto older =
        std::find_if(queue_.begin(), end, [=](const Waiting& w) { return w.sensor == sensor; });
    if (older != end) {
        // The newer reading goes to the back, as if the older had never been there: no other reading waits
        // longer.
        std::move(older + 1, end, older);
        --waiting_;
        ++losses_.displaced;
    }
    assert(waiting_ < queue_.size());
    queue_[waiting_++] = {.sensor = sensor, .reading = reading, .since = now};
}

void ReadingQueue::drop_late(NodeTime now) noexcept {
    while (waiting_ > 0 && elapsed(queue_.front().since, now) > policy_.reading_age_max) {
        remove_first(1);
        ++losses_.late;
    }
}

bool ReadingQueue::is_ready(NodeTime now) const noexcept {
    const auto time = ready_time();
    return time && is_reached(*time, now);
}

std::optional<NodeTime> ReadingQueue::ready_time() const noexcept {
    if (waiting_ == 0) return std::nullopt;
    const NodeTime since = queue_.front().since;
    return waiting_ >= frame_capacity() ? since : since + policy_.company_wait;
}

wire::Message ReadingQueue::front() const noexcept {
    assert(waiting_ > 0);
    if (!uses_can_fd_) return wire::Range{on_wire(queue_.front())};
    wire::RangeFd frame;
    frame.count = frame_count();
    for (std::uint8_t i = 0; i < frame.count; ++i) {
        const Reading& reading = queue_[i].reading;
        frame.entries[i] = {.reading = on_wire(queue_[i]),
                            .signal = {.peak_signal = reading.peak_signal, .ambient = reading.ambient}};
    }
    return frame;
}

void ReadingQueue::pop() noexcept {
    const std::uint8_t count = frame_count();
    for (std::uint8_t i = 0; i < count; ++i) {
        note_aux(queue_[i]);
        ++sent_[queue_[i].sensor];
    }
    total_sent_ += count;
    remove_first(count);
}

void ReadingQueue::note_aux(const Waiting& sent) noexcept {
    if (uses_can_fd_ || aux_every_ == 0 || sent_[sent.sensor] % aux_every_ != 0) return;
    aux_ =
        wire::RangeAux{.sensor = sent.sensor,
                       .sequence = static_cast<std::uint8_t>(sent_[sent.sensor] % wire::kSequenceCount),
                       .signal = {.peak_signal = sent.reading.peak_signal, .ambient = sent.reading.ambient}};
}

std::uint8_t ReadingQueue::frame_capacity() const noexcept {
    return uses_can_fd_ ? wire::kReadingsPerFdFrame : std::uint8_t{1};
}

std::uint8_t ReadingQueue::frame_count() const noexcept {
    return std::min(waiting_, frame_capacity());
}

wire::RangeReading ReadingQueue::on_wire(const Waiting& waiting) const noexcept {
    const Reading& reading = waiting.reading;
    return {.sensor = waiting.sensor,
            .zone = reading.zone,
            .device_status = reading.device_status,
            .sequence = static_cast<std::uint8_t>(sent_[waiting.sensor] % wire::kSequenceCount),
            .range_mm = range_on_wire(reading),
            .sigma_quarter_mm = reading.sigma_quarter_mm,
            .capture =
                uses_can_fd_ ? wire::fd_residue(reading.capture) : wire::classical_residue(reading.capture)};
}

void ReadingQueue::remove_first(std::uint8_t count) noexcept {
    std::move(queue_.begin() + count, queue_.begin() + waiting_, queue_.begin());
    waiting_ = static_cast<std::uint8_t>(waiting_ - count);
}

}  // namespace octoskin::node
