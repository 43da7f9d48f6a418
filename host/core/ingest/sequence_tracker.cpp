#include "host/core/ingest/sequence_tracker.hpp"

#include <cassert>
#include <chrono>

namespace octoskin {
namespace {

constexpr unsigned kWindow = wire::kSequenceCount / 2;

unsigned steps(std::uint8_t from, std::uint8_t to) {
    return (static_cast<unsigned>(to) - from) % wire::kSequenceCount;
}

}  // namespace

Result<SequencePlace, SequenceFault> SequenceTracker::place(std::uint8_t sequence, HostTime captured,
                                                            Nanoseconds spacing_min) const {
    assert(sequence < wire::kSequenceCount);
    if (!newest_) {
        return SequencePlace{.is_counted = false};
    }
    const std::optional<HostTime>& mine = captured_[sequence];
    const HostTime newest = *captured_[*newest_];
    if (mine && std::chrono::abs(captured - *mine) < spacing_min) {
        return unexpected(SequenceFault::duplicate);
    }
    if (captured > newest) {
        return place_later(sequence, captured, spacing_min);
    }
    const unsigned behind = steps(sequence, *newest_);
    if (behind == 0 || behind > kWindow || mine) {
        return unexpected(SequenceFault::out_of_window);
    }
    if (newest - captured < spacing_min * behind) {
        return unexpected(SequenceFault::too_soon);
    }
    return SequencePlace{.is_newest = false};
}

Result<SequencePlace, SequenceFault> SequenceTracker::place_later(std::uint8_t sequence, HostTime captured,
                                                                  Nanoseconds spacing_min) const {
    // The same number again is a whole wrap later: 63 are missing.
    const unsigned ahead = sequence == *newest_ ? wire::kSequenceCount : steps(*newest_, sequence);
    if (captured - *captured_[*newest_] < spacing_min * ahead) {
        return unexpected(ahead > kWindow ? SequenceFault::behind : SequenceFault::too_soon);
    }
    return SequencePlace{.left_out = ahead - 1, .is_counted = !has_skipped_};
}

void SequenceTracker::take(std::uint8_t sequence, HostTime captured, const SequencePlace& place) {
    captured_[sequence] = captured;
    if (!place.is_newest) {
        gaps_ -= gaps_ > 0 ? 1 : 0;
        return;
    }
    for (unsigned lost = 1; newest_ && lost <= place.left_out; ++lost) {
        captured_[(*newest_ + lost) % wire::kSequenceCount].reset();
    }
    gaps_ += place.is_counted ? place.left_out : 0;
    has_skipped_ = has_skipped_ && !newest_;
    newest_ = sequence;
}

Result<SequencePlace, SequenceFault> SequenceTracker::observe(std::uint8_t sequence, HostTime captured,
                                                              Nanoseconds spacing_min) {
    const auto found = place(sequence, captured, spacing_min);
    if (found) {
        take(sequence, captured, *found);
    }
    return found;
}

}  // namespace octoskin
