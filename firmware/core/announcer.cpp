#include "firmware/core/announcer.hpp"

#include "firmware/core/time_bracket.hpp"

namespace octoskin::node {

namespace {

constexpr std::uint8_t kAllPages = (1U << wire::kInfoPages) - 1U;

}  // namespace

Announcer::Announcer(std::uint8_t sensor_count, const Policy& policy, NodeTime now) noexcept
    : sensor_count_(sensor_count),
      heartbeat_(every(policy.heartbeat_period, now)),
      info_(every(policy.status_period / wire::kInfoPages, now)),
      health_(every(policy.status_period / (sensor_count > 0 ? sensor_count : 1), now)),
      info_due_(kAllPages) {}

Announcer::Rhythm Announcer::every(Microseconds period, NodeTime now) noexcept {
    return {.period = period, .next = now + period};
}

bool Announcer::Rhythm::beats(NodeTime now) noexcept {
    if (!is_reached(next, now)) return false;
    next = next + period;
    if (is_reached(next, now)) next = now + period;
    return true;
}

void Announcer::update(NodeTime now) noexcept {
    if (heartbeat_.beats(now)) is_heartbeat_due_ = true;
    const bool is_info_beat = info_.beats(now);
    const bool is_health_beat = health_.beats(now);
    if (is_quiet_) return;
    if (is_info_beat) {
        info_due_ |= static_cast<std::uint8_t>(1U << info_turn_);
        info_turn_ = static_cast<std::uint8_t>((info_turn_ + 1U) % wire::kInfoPages);
    }
    if (is_health_beat && sensor_count_ > 0) {
        request_health(health_turn_);
        health_turn_ = static_cast<std::uint8_t>((health_turn_ + 1U) % sensor_count_);
    }
}

NodeTime Announcer::next_due() const noexcept {
    const NodeTime status = earlier_of(info_.next, health_.next);
    return earlier_of(heartbeat_.next, status);
}

void Announcer::set_quiet(bool is_quiet) noexcept {
    is_quiet_ = is_quiet;
    info_due_ = 0;
    health_due_ = 0;
    if (!is_quiet) request_all();
}

void Announcer::request_all() noexcept {
    info_due_ = kAllPages;
    if (is_quiet_) return;  // sensors that are not at work have no health to report
    for (std::uint8_t sensor = 0; sensor < sensor_count_; ++sensor) request_health(sensor);
}

std::optional<wire::InfoPage> Announcer::info_page_due() const noexcept {
    for (std::uint8_t page = 0; page < wire::kInfoPages; ++page) {
        if ((info_due_ >> page) & 1U) return static_cast<wire::InfoPage>(page);
    }
    return std::nullopt;
}

std::optional<std::uint8_t> Announcer::health_due() const noexcept {
    if (health_due_ == 0) return std::nullopt;  // nearly always; checked in every poll
    for (std::uint8_t i = 0; i < sensor_count_; ++i) {
        const auto sensor = static_cast<std::uint8_t>((health_first_ + i) % sensor_count_);
        if ((health_due_ >> sensor) & 1U) return sensor;
    }
    return std::nullopt;
}

void Announcer::info_sent(wire::InfoPage page) noexcept {
    info_due_ &= static_cast<std::uint8_t>(~(1U << static_cast<unsigned>(page)));
}

void Announcer::health_sent(std::uint8_t sensor) noexcept {
    health_due_ &= ~(std::uint64_t{1} << sensor);
    health_first_ = static_cast<std::uint8_t>((sensor + 1U) % sensor_count_);
}

}  // namespace octoskin::node
