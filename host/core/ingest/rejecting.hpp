// Maps the faults of the intake's parts to the reasons that are counted.
#pragma once

#include <optional>

#include "host/core/ingest/node_registry.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/time/clock_map.hpp"
#include "host/core/time/host_clock.hpp"

namespace octoskin {

/// Empty: the node is usable.
[[nodiscard]] std::optional<ReadingReason> reason_of(NodeCondition verdict);
[[nodiscard]] FrameReason reason_of(SyncFault fault);

/// Times that no sensor can produce: the node's clock has jumped since the last exchange, or the reading is
/// from another sender. A jump shows at the next reading, unless it shifts readings by less than their
/// distance minus the smallest distance that the gate allows.
[[nodiscard]] bool contradicts_clock(ReadingReason reason);

template <class Reason>
[[nodiscard]] Reason clock_reason(ClockFault fault) {
    switch (fault) {
        case ClockFault::not_ready:
            return Reason::clock_not_ready;
        case ClockFault::in_doubt:
            return Reason::clock_in_doubt;
        case ClockFault::silent:
            return Reason::clock_silent;
    }
    return Reason::clock_in_doubt;
}

}  // namespace octoskin
