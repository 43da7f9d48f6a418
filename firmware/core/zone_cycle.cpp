#include "firmware/core/zone_cycle.hpp"

#include "common/range_pause.hpp"
#include "common/wire/messages.hpp"

namespace octoskin::node {

ZoneCycle::ZoneCycle(std::uint8_t zone_count, Microseconds guard) noexcept
    : zone_count_(zone_count), guard_(guard) {}

void ZoneCycle::restart() noexcept {
    after_ = 0;
    settle();
}

void ZoneCycle::settle() noexcept {
    before_ = after_;
    write_.reset();
}

std::uint8_t ZoneCycle::next() const noexcept {
    return static_cast<std::uint8_t>((after_ + 1U) % zone_count_);
}

bool ZoneCycle::fits_before(NodeTime next_range_begin, NodeTime now) const noexcept {
    return elapsed(now, next_range_begin) > guard_ + kZoneWriteMax;
}

void ZoneCycle::written(const TimeBracket& when) noexcept {
    const std::uint8_t zone = next();
    before_ = after_;
    after_ = zone;
    write_ = when;
}

void ZoneCycle::note_range(NodeTime earliest) noexcept {
    if (write_ && elapsed(write_->latest, earliest) > guard_) settle();
}

std::uint8_t ZoneCycle::in_force(const TimeBracket& begin) const noexcept {
    if (!write_) return after_;
    if (elapsed(begin.latest, write_->earliest) > guard_) return before_;
    if (elapsed(write_->latest, begin.earliest) > guard_) return after_;
    return wire::kZoneUnknown;
}

}  // namespace octoskin::node
