#include "host/core/ingest/rejecting.hpp"

namespace octoskin {

std::optional<ReadingReason> reason_of(NodeVerdict verdict) {
    switch (verdict) {
        case NodeVerdict::other_version:
            return ReadingReason::node_version;
        case NodeVerdict::quarantined:
            return ReadingReason::node_quarantined;
        case NodeVerdict::babbling:
            return ReadingReason::node_babbling;
        case NodeVerdict::absent:
            return ReadingReason::node_absent;
        case NodeVerdict::lost:
            return ReadingReason::node_lost;
        case NodeVerdict::time_suspect:
            return ReadingReason::node_time_suspect;
        case NodeVerdict::info_incomplete:
            return ReadingReason::node_info_incomplete;
        case NodeVerdict::info_mismatch:
            return ReadingReason::node_info_mismatch;
        case NodeVerdict::build_refused:
            return ReadingReason::node_build_refused;
        case NodeVerdict::usable:
            return std::nullopt;
    }
    return ReadingReason::node_absent;
}

bool contradicts_clock(ReadingReason reason) {
    return reason == ReadingReason::too_soon || reason == ReadingReason::too_young ||
           reason == ReadingReason::out_of_window || reason == ReadingReason::clock_in_doubt;
}

FrameReason reason_of(SyncFault fault) {
    switch (fault) {
        case SyncFault::unmatched:
            return FrameReason::sync_unmatched;
        case SyncFault::repeated:
            return FrameReason::sync_repeated;
        case SyncFault::contradicted:
            return FrameReason::sync_contradicted;
    }
    return FrameReason::sync_unmatched;
}

}  // namespace octoskin
