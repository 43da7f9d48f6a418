#include "host/core/pipeline/measurement_queue.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace octoskin {
namespace {

/// A depth frame this far in the future has a wrong epoch.
constexpr Nanoseconds kDepthAheadMax{1'000'000'000};
/// Much less than any timing budget: two readings of one source this close are the same reading, placed by
/// two states of the clock map.
constexpr Nanoseconds kSameReading{5'000'000};
template <class T>
using Pushed = typename ReorderBuffer<T>::Pushed;

}  // namespace

MeasurementQueue::MeasurementQueue(Release release, const QueueLimits& limits,
                                   std::span<const std::string> cameras)
    : release_(release), joint_samples_(limits.joint_samples), readings_(limits.readings) {
    for (const std::string& name : cameras) {
        const auto before = std::ranges::count_if(cameras, [&](const auto& other) { return other < name; });
        cameras_.push_back(
            {ReorderBuffer<DepthFrame>(limits.depth_frames), static_cast<std::uint8_t>(before)});
    }
}

/// Node 0 is the host.
ReleaseKey MeasurementQueue::key_of(const DepthFrame& frame) const {
    return {frame.captured, {.sensor = cameras_.at(frame.camera).rank}};
}

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
    const ReleaseKey key = key_of(frame);
    ReorderBuffer<DepthFrame>& frames = cameras_.at(frame.camera).frames;
    if (frames.is_full() || frames.push(key, std::move(frame)) != Pushed<DepthFrame>::waits)
        return DepthReason::queue_overflow;
    return std::nullopt;
}

std::optional<DepthReason> MeasurementQueue::check_arrival(const DepthFrame& frame,
                                                           std::optional<HostTime> now) {
    std::optional<HostTime>& newest = cameras_.at(frame.camera).newest;
    if (newest && frame.captured <= *newest) return DepthReason::out_of_order;
    if (now && frame.captured - *now > kDepthAheadMax) return DepthReason::ahead_of_time;
    if (is_late(key_of(frame))) return DepthReason::late;
    newest = frame.captured;
    return std::nullopt;
}

std::optional<JointMeasurement> MeasurementQueue::take_joints(HostTime until) {
    const auto oldest = joint_samples_.front();
    if (!oldest || oldest->captured > until) return std::nullopt;
    return joint_samples_.pop();
}

std::optional<MeasurementQueue::Next> MeasurementQueue::next(CameraSet wanted) const {
    std::optional<Next> next;
    if (const auto reading = readings_.front()) next = Next{*reading};
    for (std::size_t camera = 0; camera < cameras_.size(); ++camera) {
        const auto depth = wanted.test(camera) ? oldest_depth(camera) : std::nullopt;
        if (depth && (!next || depth->key < next->key)) next = depth;
    }
    return next;
}

std::optional<MeasurementQueue::Next> MeasurementQueue::oldest_depth(std::size_t camera) const {
    const auto key = cameras_.at(camera).frames.front();
    return key ? std::optional(Next{*key, camera}) : std::nullopt;
}

void MeasurementQueue::forget_time(std::optional<HostTime> begin) {
    assert(readings_.size() == 0 && joint_samples_.size() == 0);
    newest_used_.reset();
    used_.clear();
    for (Camera& camera : cameras_) {
        assert(camera.frames.size() == 0);
        camera.newest.reset();
    }
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
