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

Status<SequenceFault> SequenceTracker::observe(std::uint8_t sequence, HostTime captured,
                                               Nanoseconds spacing_min) {
    assert(sequence < wire::kSequenceCount);
    std::optional<HostTime>& mine = captured_[sequence];
    if (!newest_) {
        newest_ = sequence;
        mine = captured;
        return Done{};
    }
    const HostTime newest = *captured_[*newest_];
    if (mine && std::chrono::abs(captured - *mine) < spacing_min) {
        return unexpected(SequenceFault::duplicate);
    }
    if (captured > newest) {
        if (captured - newest < spacing_min) {
            return unexpected(SequenceFault::too_soon);
        }
        // The same number again is a whole turn later: 63 are missing.
        const unsigned ahead = sequence == *newest_ ? wire::kSequenceCount : steps(*newest_, sequence);
        for (unsigned lost = 1; lost < ahead; ++lost) {
            captured_[(*newest_ + lost) % wire::kSequenceCount].reset();
        }
        gaps_ += has_skipped_ ? 0 : ahead - 1;
        has_skipped_ = false;
        newest_ = sequence;
        mine = captured;
        return Done{};
    }
    const unsigned behind = steps(sequence, *newest_);
    if (behind == 0 || behind > kWindow || mine) {
        return unexpected(SequenceFault::out_of_window);
    }
    if (newest - captured < spacing_min * behind) {
        return unexpected(SequenceFault::too_soon);
    }
    mine = captured;
    gaps_ -= gaps_ > 0 ? 1 : 0;
    return Done{};
}

}  // namespace octoskin
