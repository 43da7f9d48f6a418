#include "host/apps/playback/log_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <variant>

#include "common/wire/codec.hpp"

namespace octoskin {

bool LogSurvey::is_heartbeat_of_rig(const wire::CanFrame& frame) const {
    const auto decoded = wire::decode(frame);
    return decoded && std::holds_alternative<wire::Heartbeat>(decoded->message) &&
           std::ranges::any_of(rig_.nodes,
                               [&](const HostNode& node) { return node.node_id == decoded->node_id; });
}

void LogSurvey::take(const candump::LogEntry& entry) {
    if (interface_ && entry.interface != *interface_) return;
    const bool is_chosen = interface_ || is_heartbeat_of_rig(entry.frame);
    if (is_chosen || followed_.size() < kInterfacesMax) followed_.try_emplace(entry.interface, rig_, intake_);
    if (const auto followed = followed_.find(entry.interface); followed != followed_.end())
        followed->second.on_frame(entry.frame, entry.stamp);
    if (is_chosen) {
        interface_ = entry.interface;
    } else {
        all_.on_frame(entry.frame, entry.stamp);
    }
}

IntakeConfig LogSurvey::intake_for_stamps() const {
    IntakeConfig intake = intake_;
    const Nanoseconds grain = stamp_grain();
    if (grain.count() == 0 || grain > StampGrain::kBridgedMax) return intake;
    intake.clock.now_slack += std::chrono::ceil<Microseconds>(grain);
    intake.host_clock.ahead_tolerance = std::min(intake.host_clock.ahead_tolerance, StampGrain::kAheadMax);
    return intake;
}

std::optional<std::string> LogSurvey::warning() const {
    const StartScan& scan = chosen().scan;
    if (scan.has_start()) return std::nullopt;
    if (scan.ignored().count > 0) {
        return fmt::format(
            "can.log: {} START not used (mark_ignored), the last because its time differs by {:+.3f} s from "
            "its arrival, and {} s are allowed; the map begins at the first usable reading",
            scan.ignored().count, 1e-9 * static_cast<double>(scan.ignored().ahead.count()),
            MarkGate::kApartMax.count() / 1'000'000'000);
    }
    if (scan.waiting() > 0) {
        return "can.log: a START or STOP not used (mark_ignored): without a SYNC and its FOLLOW_UP its time "
               "is unknown; the map begins at the first usable reading";
    }
    return std::nullopt;
}

}  // namespace octoskin
