#include "host/core/ingest/rejecting.hpp"

namespace octoskin {

std::optional<ReadingReason> reason_of(NodeCondition verdict) {
    switch (verdict) {
        case NodeCondition::other_version:
            return ReadingReason::node_version;
        case NodeCondition::quarantined:
            return ReadingReason::node_quarantined;
        case NodeCondition::babbling:
            return ReadingReason::node_babbling;
        case NodeCondition::absent:
            return ReadingReason::node_absent;
        case NodeCondition::lost:
            return ReadingReason::node_lost;
        case NodeCondition::time_suspect:
            return ReadingReason::node_time_suspect;
        case NodeCondition::info_incomplete:
            return ReadingReason::node_info_incomplete;
        case NodeCondition::info_mismatch:
            return ReadingReason::node_info_mismatch;
        case NodeCondition::build_refused:
            return ReadingReason::node_build_refused;
        case NodeCondition::usable:
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
