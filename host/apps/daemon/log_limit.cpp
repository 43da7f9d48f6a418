#include "host/apps/daemon/log_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace octoskin {

void LogLimit::log(const spdlog::details::log_msg& message) {
    const std::lock_guard lock(mutex_);
    Level& level = levels_.at(static_cast<std::size_t>(message.level));
    if (message.level < spdlog::level::critical && !takes(level)) {
        ++level.left_out;
        return;
    }
    if (const std::uint64_t left_out = std::exchange(level.left_out, 0); left_out > 0) {
        const std::string text = fmt::format(
            "{} lines are left out here, because there were too many; `octoskin status` lists the problems",
            left_out);
        pass({message.logger_name, message.level, text});
    }
    pass(message);
}

bool LogLimit::takes(Level& level) {
    const HostTime now = now_();
    if (!level.grown) level.grown = now;
    const auto grown = (now - *level.grown) / kPeriod;
    level.room = static_cast<int>(std::min<std::int64_t>(kAtOnce, level.room + grown));
    level.grown = level.room == kAtOnce ? now : *level.grown + kPeriod * grown;
    if (level.room == 0) return false;
    --level.room;
    return true;
}

void LogLimit::pass(const spdlog::details::log_msg& message) {
    for (const auto& each : sinks_)
        if (each->should_log(message.level)) each->log(message);
}

void LogLimit::flush() {
    const std::lock_guard lock(mutex_);
    for (const auto& each : sinks_) each->flush();
}

void LogLimit::set_pattern(const std::string& pattern) {
    const std::lock_guard lock(mutex_);
    for (const auto& each : sinks_) each->set_pattern(pattern);
}

void LogLimit::set_formatter(std::unique_ptr<spdlog::formatter> formatter) {
    const std::lock_guard lock(mutex_);
    for (const auto& each : sinks_) each->set_formatter(formatter->clone());
}

}  // namespace octoskin
