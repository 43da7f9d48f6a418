#include "host/apps/explain/voxel_trace.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace octoskin {

void VoxelTrace::on_reading(const RangeMeasurement& measurement, const Beam& beam,
                            std::span<const VoxelUpdate> updates) {
    Contribution contribution;
    contribution.source = measurement.source;
    contribution.captured = measurement.captured;
    captured_ = measurement.captured;
    contribution.range_m = measurement.range_m;
    contribution.p_map_sensor = beam.p_map_sensor;
    contribution.direction_map = beam.direction_map;
    take(std::move(contribution), updates);
}

void VoxelTrace::on_depth(const DepthFrame& frame, const Evidence& terms) {
    Contribution contribution;
    contribution.source = source_of_camera(frame.camera);
    contribution.frame = depth_frames_[frame.camera]++;
    contribution.captured = frame.captured;
    captured_ = frame.captured;
    const VoxelUpdate update{key_, term_of(terms, key_)};
    take(std::move(contribution), std::span(&update, 1));
}

void VoxelTrace::on_older(std::optional<HostTime> now, const FusedMap& map) {
    if (now_ && !map.log_odds(key_)) forget(now);
}

void VoxelTrace::forget(std::optional<HostTime> now) {
    ++forgotten_.times;
    forgotten_.change -= static_cast<double>(*now_);
    forgotten_.last = now;
    forgotten_.is_last = true;
    for (auto& share : shares_) share.second.kept = 0.0;
    now_.reset();
}

void VoxelTrace::on_fused(const FusedMap& map) {
    const auto now = map.log_odds(key_);
    if (now_ && !now && !is_newest_of_commit_) return forget(captured_);  // weakened
    if (now == now_ && !map.layers().counts.has(brick_of(key_))) return;
    now_ = now;
    if (!is_newest_of_commit_ || newest_.empty()) return;
    Contribution& newest = newest_.back();
    const double before = newest.change();
    newest.after = now_.value_or(0.0F);
    SourceShare& share = shares_[newest.source];
    share.change += newest.change() - before;
    share.kept += newest.change() - before;
}

double VoxelTrace::sum() const {
    double sum = static_cast<double>(begin_.value_or(0.0F)) + forgotten_.change;
    for (const auto& share : shares_) sum += share.second.change;
    return sum;
}

void VoxelTrace::take(Contribution contribution, std::span<const VoxelUpdate> updates) {
    is_newest_of_commit_ = false;
    for (const VoxelUpdate& update : updates) {
        // As in FusedMap::apply: a zero term and a term that is not finite leave the voxel unchanged.
        if (update.key != key_ || update.log_odds == 0.0F || !std::isfinite(update.log_odds)) continue;
        contribution.term = update.log_odds;
        contribution.before = now_.value_or(0.0F);
        contribution.after =
            std::clamp(contribution.before + update.log_odds, config_.log_odds_min, config_.log_odds_max);
        now_ = contribution.after;
        const auto [share, is_first] = shares_.try_emplace(contribution.source);
        ++(contribution.term > 0.0F ? share->second.hits : share->second.misses);
        share->second.change += contribution.change();
        share->second.kept += contribution.change();
        forgotten_.is_last = false;
        if (is_first) share->second.first = contribution.captured;
        share->second.last = contribution.captured;
        ++count_;
        newest_.push_back(contribution);
        if (newest_.size() > kept_max_) newest_.pop_front();
        is_newest_of_commit_ = true;
    }
}

}  // namespace octoskin
