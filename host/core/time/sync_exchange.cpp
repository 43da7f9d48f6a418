#include "host/core/time/sync_exchange.hpp"

#include <cassert>

namespace octoskin {

Status<SyncFault> SyncExchange::on_sync(const wire::Sync& sync, WallTime stamp) {
    const bool is_repeated = sync.sequence == sequence_last_;
    sequence_last_ = sync.sequence;
    stamp_ = stamp;
    host_.reset();
    reports_.fill({});
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
    // 48 bits of microseconds are 8.9 years: times 1000 they stay far below 2^63.
    host_ = HostTime{static_cast<std::int64_t>(follow_up.host_time_us) * 1000};
    return SyncStamp{*host_, stamp_};
}

Status<SyncFault> SyncExchange::on_report(wire::NodeId node, const wire::SyncReport& report) {
    assert(node < reports_.size());
    if (sequence_ != report.sequence) {
        return unexpected(SyncFault::unmatched);
    }
    Report& mine = reports_[node];
    if (mine.answer != Answer::none) {
        return unexpected(SyncFault::repeated);
    }
    mine = {Answer::waiting, report.heard};
    return Done{};
}

std::optional<SyncSample> SyncExchange::take_sample(wire::NodeId node) {
    assert(node < reports_.size());
    Report& mine = reports_[node];
    if (!host_ || mine.answer != Answer::waiting) {
        return std::nullopt;
    }
    mine.answer = Answer::taken;
    return SyncSample{*host_, mine.heard};
}

}  // namespace octoskin
