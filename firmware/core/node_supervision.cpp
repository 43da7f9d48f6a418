// Supervision of the node: its run record, safe mode, bus-off recovery and the watchdog.
#include <limits>

#include "firmware/core/node.hpp"

namespace octoskin::node {

namespace {

/// How often the record is updated: the length of a run is known this well after it ended.
constexpr Microseconds kUptimeStep{100'000};
constexpr std::uint32_t kUptimeStepMs = 100;

}  // namespace

void Node::start_run(NodeTime now) {
    const RunRecord last = ports_.kept != nullptr ? load(*ports_.kept) : RunRecord{};
    const RunStart start =
        identity_.run ? *identity_.run : begin_run(last, identity_.reset_cause, policy_.run_rules);
    run_ = start.record;
    run_.is_starting = false;
    reset_cause_ = start.cause;
    keep_run_record();
    if (is_safe()) {
        announcer_.set_quiet(true);
    } else {
        create_sensors(now);
    }
}

void Node::keep_run_record() noexcept {
    if (ports_.kept != nullptr) save(run_, *ports_.kept);
}

void Node::count_uptime(NodeTime now) {
    if (elapsed(uptime_counted_, now) < kUptimeStep) return;
    uptime_counted_ = uptime_counted_ + kUptimeStep;
    if (uptime_ms_ <= std::numeric_limits<std::uint32_t>::max() - kUptimeStepMs) uptime_ms_ += kUptimeStepMs;
    judge_run(now);
    forward_faults();
    run_.uptime_ms = uptime_ms_;
    keep_run_record();
    // Updating all of them in every poll would be a tenth of the core's time.
    for (auto& reflex : reflexes_) {
        if (reflex) reflex->update(now);
    }
}

void Node::judge_run(NodeTime now) {
    const std::uint32_t in_mode_s = (uptime_ms_ - mode_since_ms_) / 1'000;
    if (is_safe() && in_mode_s >= safe_mode_s(run_.retries)) {
        leave_safe_mode(RunMode::retry, now);
    } else if (run_.mode == RunMode::retry && in_mode_s >= policy_.retry_proven_s) {
        run_.mode = RunMode::normal;
        run_.retries = 0;
        run_.resets = 0;
    }
}

void Node::leave_safe_mode(RunMode mode, NodeTime now) {
    run_.mode = mode;
    if (mode == RunMode::normal) {
        run_.retries = 0;
        run_.resets = 0;
    }
    mode_since_ms_ = uptime_ms_;
    keep_run_record();
    announcer_.set_quiet(false);
    create_sensors(now);
}

void Node::supervise_can(NodeTime now) {
    can_state_ = ports_.can.state();
    switch (bus_off_.update(can_state_, now)) {
        case BusOffRecovery::Action::none:
            break;
        case BusOffRecovery::Action::discard:
            ports_.can.discard();
            break;
        case BusOffRecovery::Action::restart:
            ports_.can.restart();
            break;
        case BusOffRecovery::Action::resume:
            if (!is_safe()) announcer_.request_info(wire::InfoPage::traffic);
            break;
    }
}

/// By the node's own clock: a clock that stops never feeds.
void Node::feed_watchdog(NodeTime now) {
    if (ports_.watchdog == nullptr || !is_reached(feed_at_, now)) return;
    for (const auto& recorder : recorders_) {
        if (recorder && recorder->is_overdue(now)) return;
    }
    feed_at_ = now + policy_.watchdog_feed;
    ports_.watchdog->feed();
}

}  // namespace octoskin::node
