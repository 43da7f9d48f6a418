#include "host/apps/playback/pace.hpp"

#include <fmt/format.h>

#include <cassert>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "host/io/candump/log_line.hpp"

namespace octoskin {
namespace {

/// Longer gaps of a recording are skipped.
constexpr std::int64_t kJumpMax_ns = 60'000'000'000;

std::int64_t steady_now_ns() {
    return std::chrono::steady_clock::now().time_since_epoch().count();
}

std::string text_of(const StampedFrame& entry, const std::string& interface) {
    std::string line = candump::format_line({entry.stamp, interface, entry.frame});
    line.pop_back();
    return line;
}

std::string text_of(const DepthFrame& frame, std::uint64_t index) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    return fmt::format("depth image {} of {}.{:09}: {} x {}", index, frame.captured.ns / kSecond_ns,
                       frame.captured.ns % kSecond_ns, frame.width, frame.height);
}

struct Describe {
    std::string operator()(const JointMeasurement&) const { return "joint sample"; }
    std::string operator()(const RangeMeasurement& reading) const {
        const auto& [node, sensor, zone] = reading.source;
        const std::string range = reading.range_m ? fmt::format("{:.3f} m", *reading.range_m) : "no target";
        return fmt::format("reading of node {} sensor {} zone {}: {}", node, sensor, zone, range);
    }
    std::string operator()(const DepthCommit& frame) const {
        return frame.index ? fmt::format("depth frame {}", *frame.index)
                           : "depth frame without a recorded image";
    }
    std::string operator()(const WaitCommit&) const { return "time without a measurement"; }
};

/// Empty if the commit has no time.
struct TimeOf {
    std::optional<HostTime> operator()(const JointMeasurement& joints) const { return joints.sampled; }
    std::optional<HostTime> operator()(const RangeMeasurement& reading) const { return reading.captured; }
    std::optional<HostTime> operator()(const DepthCommit& frame) const { return frame.captured; }
    std::optional<HostTime> operator()(const WaitCommit&) const { return std::nullopt; }
};

}  // namespace

Pace Pace::times(double speed) {
    assert(std::isfinite(speed) && speed > 0.0);
    Pace pace;
    pace.speed_ = speed;
    return pace;
}

Pace Pace::by_step(Step step) {
    Pace pace;
    pace.step_ = std::move(step);
    return pace;
}

void Pace::wait(std::int64_t time_ns, const std::string& what) {
    if (step_) return step_(what);
    if (!speed_) return;
    // Measurements of several sources are slightly out of order: only a large step back restarts the time
    // base.
    constexpr std::int64_t kBackMax_ns = 1'000'000'000;
    const bool leaps = time_ns - newest_ns_ > kJumpMax_ns || newest_ns_ - time_ns > kBackMax_ns;
    if (!has_begun_ || leaps) {
        has_begun_ = true;
        first_ns_ = time_ns;
        began_steady_ns_ = steady_now_ns();
    }
    newest_ns_ = time_ns;
    const auto after_ns = std::llround(static_cast<double>(time_ns - first_ns_) / *speed_);
    const std::int64_t left_ns = began_steady_ns_ + after_ns - steady_now_ns();
    if (left_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(left_ns));
}

Result<std::optional<StampedFrame>, Error> PacedCan::next() {
    auto entry = source_.next();
    if (pace_.waits() && entry && entry->has_value())
        pace_.wait((*entry)->stamp.ns,
                   pace_.steps() ? text_of(**entry, source_.newest_interface()) : std::string());
    return entry;
}

Result<std::optional<DepthFrame>, Error> PacedDepth::next() {
    auto frame = source_.next();
    if (!pace_.waits() || !frame || !frame->has_value()) return frame;
    pace_.wait((*frame)->captured.ns, pace_.steps() ? text_of(**frame, frames_) : std::string());
    ++frames_;
    return frame;
}

Result<std::optional<Commit>, Error> PacedCommits::next() {
    auto commit = source_.next();
    if (!pace_.waits() || !commit || !commit->has_value()) return commit;
    const auto time = std::visit(TimeOf{}, **commit);
    if (!time) return commit;
    // A step is a reading or a frame. Joint samples are no steps: they only give the robot's pose.
    const bool is_step = !std::holds_alternative<JointMeasurement>(**commit);
    has_begun_ = has_begun_ || is_step || (begin_ && *time >= *begin_);
    if (is_step || (has_begun_ && !pace_.steps())) pace_.wait(time->ns, std::visit(Describe{}, **commit));
    return commit;
}

}  // namespace octoskin
