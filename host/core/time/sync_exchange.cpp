#include "host/core/time/sync_exchange.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <span>

namespace octoskin {
namespace {

bool are_one(NodeTime a, NodeTime b) {
    return std::chrono::abs(elapsed(a, b)) <= SyncExchange::kOneInstant;
}

}  // namespace

Status<SyncFault> SyncExchange::on_sync(const wire::Sync& sync, WallTime stamp) {
    const bool is_repeated = sync.sequence == sequence_last_;
    sequence_last_ = sync.sequence;
    stamp_ = stamp;
    host_.reset();
    answers_.fill({});
    if (is_repeated) {
        sequence_.reset();
        return unexpected(SyncFault::repeated);
    }
    sequence_ = sync.sequence;
    return Done{};
}

Result<SyncStamp, SyncFault> SyncExchange::on_follow_up(const wire::FollowUp& follow_up) {
    if (sequence_ != follow_up.sequence) {
        return unexpected(SyncFault::unmatched);
    }
    if (host_) {
        return unexpected(SyncFault::repeated);
    }
    // 48 bits of microseconds are 8.9 years; times 1000 they stay far below 2^63.
    host_ = HostTime{static_cast<std::int64_t>(follow_up.host_time_us) * 1000};
    return SyncStamp{*host_, stamp_};
}

Status<SyncFault> SyncExchange::on_report(wire::NodeId node, const wire::SyncReport& report) {
    assert(node < answers_.size());
    if (sequence_ != report.sequence) {
        return unexpected(SyncFault::unmatched);
    }
    Answers& mine = answers_[node];
    const auto before = std::span(mine.heard).first(mine.count);
    if (std::ranges::find(before, report.heard) != before.end()) {
        return unexpected(SyncFault::repeated);
    }
    const bool may_be_one = !before.empty() && are_one(before.front(), report.heard);
    if (mine.count < mine.heard.size()) {
        mine.heard[mine.count] = report.heard;
        ++mine.count;
    }
    mine.has_new = true;
    if (before.empty()) return Done{};
    return unexpected(may_be_one ? SyncFault::repeated : SyncFault::contradicted);
}

std::vector<SyncSample> SyncExchange::take_samples(wire::NodeId node) {
    assert(node < answers_.size());
    Answers& mine = answers_[node];
    std::vector<SyncSample> samples;
    if (!host_ || !mine.has_new) {
        return samples;
    }
    mine.has_new = false;
    for (const NodeTime heard : std::span(mine.heard).first(mine.count)) {
        samples.push_back({*host_, heard});
    }
    return samples;
}

}  // namespace octoskin
