#include "host/core/pipeline/measurement_queue.hpp"

#include <cassert>
#include <utility>

namespace octoskin {
namespace {

/// A depth frame this far in the future has a wrong epoch.
constexpr Nanoseconds kDepthAheadMax{1'000'000'000};
/// Much less than any timing budget: two readings of one source this close are the same reading, placed by
/// two states of the clock map.
constexpr Nanoseconds kSameReading{5'000'000};
/// The camera's rank in the order of sources: node 0 is the host.
constexpr BeamSource kCameraSource{};

template <class T>
using Pushed = typename ReorderBuffer<T>::Pushed;

}  // namespace

MeasurementQueue::MeasurementQueue(Release release, const QueueLimits& limits)
    : release_(release),
      joint_samples_(limits.joint_samples),
      readings_(limits.readings),
      depth_frames_(limits.depth_frames) {}

std::optional<ReadingReason> MeasurementQueue::put(const RangeMeasurement& measurement) {
    const ReleaseKey key{measurement.captured, measurement.source};
    if (is_late(key)) return ReadingReason::late;
    if (is_repeated(key)) return ReadingReason::duplicate;
    if (readings_.push(key, measurement) != Pushed<RangeMeasurement>::waits)
        return ReadingReason::queue_overflow;
    return std::nullopt;
}

std::optional<JointReason> MeasurementQueue::put(const JointMeasurement& joints) {
    switch (joint_samples_.push({joints.sampled, {.sensor = joints.source}}, joints)) {
        case Pushed<JointMeasurement>::waits:
            return std::nullopt;
        case Pushed<JointMeasurement>::refused:
            return JointReason::out_of_order;
        case Pushed<JointMeasurement>::displaced:
            return JointReason::queue_overflow;
    }
    return std::nullopt;
}

std::optional<DepthReason> MeasurementQueue::put(DepthFrame frame) {
    const ReleaseKey key{frame.captured, kCameraSource};
    if (depth_frames_.is_full() || depth_frames_.push(key, std::move(frame)) != Pushed<DepthFrame>::waits)
        return DepthReason::queue_overflow;
    return std::nullopt;
}

std::optional<DepthReason> MeasurementQueue::check_arrival(const DepthFrame& frame,
                                                           std::optional<HostTime> now) {
    if (newest_depth_ && frame.captured <= *newest_depth_) return DepthReason::out_of_order;
    if (now && frame.captured - *now > kDepthAheadMax) return DepthReason::ahead_of_time;
    if (is_late({frame.captured, kCameraSource})) return DepthReason::late;
    newest_depth_ = frame.captured;
    return std::nullopt;
}

std::optional<JointMeasurement> MeasurementQueue::take_joints(HostTime until) {
    const auto oldest = joint_samples_.front();
    if (!oldest || oldest->captured > until) return std::nullopt;
    return joint_samples_.pop();
}

std::optional<MeasurementQueue::Next> MeasurementQueue::next(bool depth_wanted) const {
    const auto reading = readings_.front();
    const auto depth = depth_wanted ? depth_frames_.front() : std::nullopt;
    if (depth && (!reading || *depth < *reading)) return Next{*depth, true};
    if (reading) return Next{*reading, false};
    return std::nullopt;
}

void MeasurementQueue::forget_time(std::optional<HostTime> begin) {
    assert(readings_.size() == 0 && joint_samples_.size() == 0 && depth_frames_.size() == 0);
    newest_used_.reset();
    used_.clear();
    newest_depth_.reset();
    begin_ = begin;
}

bool MeasurementQueue::is_late(const ReleaseKey& key) const {
    if (begin_ && key.captured < *begin_) return true;
    return release_ == Release::by_capture_time && newest_used_ && key <= *newest_used_;
}

bool MeasurementQueue::is_repeated(const ReleaseKey& key) const {
    const auto used = used_.find(key.source);
    return (used != used_.end() && key.captured - used->second < kSameReading) ||
           readings_.has_near(key, kSameReading);
}

}  // namespace octoskin
