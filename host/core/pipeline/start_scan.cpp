#include "host/core/pipeline/start_scan.hpp"

namespace octoskin {

void StartScan::judge(const wire::Mark& mark, bool is_taken, std::optional<HostTime> now) {
    if (mark.kind != wire::MarkKind::start) {
        return;
    }
    has_start_ = has_start_ || is_taken;
    if (!is_taken && now) {
        ignored_ = {ignored_.count + 1, MarkWindow::time_of(mark) - *now};
    }
}

void StartScan::on_frame(const wire::CanFrame& frame, WallTime stamp) {
    const FrameOutcome outcome = intake_.on_frame(frame, stamp);
    const auto now = intake_.now();
    if (outcome.mark) {
        const MarkGate::Fate fate = marks_.take(*outcome.mark, now);
        if (fate != MarkGate::Fate::waits) {
            judge(*outcome.mark, fate == MarkGate::Fate::taken, now);
        }
    }
    if (now) {
        for (const MarkGate::Settled& settled : marks_.settle(*now)) {
            judge(settled.mark, settled.is_taken, now);
        }
    }
}

}  // namespace octoskin
