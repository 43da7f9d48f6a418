#include "host/apps/octoskin/joint_forwarder.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "common/cut_text.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/core/kinematics/joint_history.hpp"

namespace octoskin::app {
namespace {

/// The beginning of a line that may be long.
std::string shown(const std::string& line) {
    constexpr std::size_t kShown = 120;
    return cut_text(line, kShown);
}

std::string lines(std::uint64_t count) {
    return fmt::format("{} line{}", count, count == 1 ? "" : "s");
}

}  // namespace

std::optional<Error> RigJoints::fault_of(const JointLine& line) const {
    for (const JointSample& sample : line.samples) {
        const auto& names = joints.sources[sample.source].names;
        for (std::size_t i = 0; i < sample.position.size(); ++i) {
            const JointLimits& limit = limits[sample.source][i];
            if (limit.hold(sample.position[i], JointHistoryConfig{}.limit_tolerance)) continue;
            return Error{.code = ErrorCode::out_of_range,
                         .what = fmt::format("expected {} to {}, the robot's limits", limit.min, limit.max),
                         .value = fmt::format("{}", sample.position[i]),
                         .key = fmt::format("joint {} of {}, {}", i + 1, names.size(), names[i])};
        }
    }
    return std::nullopt;
}

JointForwarder::JointForwarder(JointOutput& output, std::optional<RigJoints> joints,
                               std::vector<JointBurst> bursts)
    : output_(output), joints_(std::move(joints)), bursts_(std::move(bursts)) {}

void JointForwarder::begin_block() {
    now_ = monotonic_now();
    came_ = wall_now();
}

void JointForwarder::put(const std::string& line) {
    if (!joints_) return send(line, std::nullopt);
    // It counts as sampled now unless it has a time.
    auto parsed = parse_joints(line, joints_->joints, now_, now_);
    if (!parsed) {
        const char* const name = names_of(parsed.error()).at(static_cast<std::size_t>(parsed.error()));
        return refuse(name, {.code = ErrorCode::bad_syntax,
                             .what = describe(parsed.error(), line, joints_->joints, now_),
                             .value = "'" + shown(line) + "'",
                             .remedy = fmt::format("write lines of the form {}", kJointTextWanted)});
    }
    if (auto fault = joints_->fault_of(*parsed)) {
        fault->others = "The line is " + shown(line);
        return refuse("out_of_limits", std::move(*fault));
    }
    if (bursts_.empty()) return send(line, *parsed);
    parsed->came = came_;
    waiting_.push_back(std::move(*parsed));
}

void JointForwarder::send_due() {
    send_until(wall_now());
}

void JointForwarder::send_until(WallTime now) {
    while (!waiting_.empty() && thin_oldest(now)) {
        const JointLine oldest = std::move(waiting_.front());
        waiting_.pop_front();
        if (oldest.samples.empty()) {
            ++thinned_;
        } else {
            send({}, oldest);
        }
    }
}

/// Takes the samples out of the oldest line that a newer one of the same source replaces. False: the line
/// waits.
bool JointForwarder::thin_oldest(WallTime now) {
    bool is_due = true;
    std::erase_if(waiting_.front().samples, [&](const JointSample& sample) {
        const JointBurst::Turn turn = turn_in_oldest(sample.source, now);
        is_due = is_due && turn != JointBurst::Turn::wait;
        return turn == JointBurst::Turn::drop;
    });
    return is_due;
}

JointBurst::Turn JointForwarder::turn_in_oldest(std::size_t source, WallTime now) {
    const JointLine& oldest = waiting_.front();
    JointBurst& burst = bursts_.at(source);
    return oldest.has_own_time ? burst.use(oldest.came)
                               : burst.turn_of(oldest.came, next_after_oldest(source), now);
}

/// When the next line with a sample of this source came.
std::optional<WallTime> JointForwarder::next_after_oldest(std::size_t source) const {
    const auto has_source = [source](const JointLine& line) {
        return std::ranges::find(line.samples, source, &JointSample::source) != line.samples.end();
    };
    const auto next = std::find_if(waiting_.begin() + 1, waiting_.end(), has_source);
    return next == waiting_.end() ? std::nullopt : std::optional(next->came);
}

void JointForwarder::send(const std::string& line, const std::optional<JointLine>& parsed) {
    switch (output_.put(line, parsed)) {
        case JointOutput::Fate::sent:
            return note_sent();
        case JointOutput::Fate::lost:
            return lose();
        case JointOutput::Fate::thinned:
            ++thinned_;
    }
}

void JointForwarder::note_sent() {
    if (!losses_reported_.empty()) spdlog::info("samples are sent again; so far lost: {}", lines(lost_));
    losses_reported_.clear();
    refusals_reported_.clear();
    ++sent_;
}

void JointForwarder::finish() {
    send_until(WallTime{std::numeric_limits<std::int64_t>::max()});
    const auto level = lost_ + refused_ > 0 ? spdlog::level::warn : spdlog::level::info;
    const std::string thinned = thinned_ > 0 ? fmt::format(", {} thinned to the rig's rate", thinned_) : "";
    spdlog::log(level, "{} sent, {} lost, {} refused{}", lines(sent_), lost_, refused_, thinned);
    if (sent_ == 0 && lost_ + refused_ > 0) throw CommandFailure(ExitCode::unavailable, why_);
}

void JointForwarder::lose() {
    ++lost_;
    why_ = output_.why().value_or(Error{.code = ErrorCode::no_data});
    const std::string why = why_.message();
    if (why.empty() || losses_reported_.size() >= kLossesTold || !losses_reported_.insert(why).second) return;
    spdlog::warn("{}; waiting for it; lines are lost meanwhile", why);
}

void JointForwarder::refuse(const char* reason, Error why) {
    ++refused_;
    why_ = std::move(why);
    if (!refusals_reported_.insert(reason).second) return;
    const std::string text = why_.message();  // of a line's form it begins with the reason
    spdlog::warn("line not sent, {}", text.starts_with(reason) ? text : fmt::format("{}: {}", reason, text));
}

}  // namespace octoskin::app
