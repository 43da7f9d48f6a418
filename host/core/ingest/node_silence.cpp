#include "host/core/ingest/node_silence.hpp"

#include <algorithm>

namespace octoskin {
namespace {

struct Look {
    const SensorRecord& record;
    Nanoseconds period;
    SensorSilence what;
};

/// Whether the data that one sensor does not deliver arrive from another sensor, or from all others.
enum class Comes : std::uint8_t { no, unclear, yes };

/// All sensors that fall silent at once were last heard within a second of each other, because SENSOR_HEALTH
/// comes once a second. Another second may pass until all are heard again.
Comes are_words_of(const SensorRecord& other, const SensorRecord& silent, HostTime now) {
    constexpr Nanoseconds kSure{1'500'000'000};
    const auto& newest = other.words.newest();
    const auto& before = silent.words.newest();
    if (!newest || !before || *newest - *before <= kSure) return Comes::no;
    if (other.words.length() >= kSure) return Comes::yes;
    return now - *newest < kSure ? Comes::unclear : Comes::no;
}

/// Loses readings in the newest step or over all steps. If all sensors lose about as many, or none loses any
/// more, each one's own next SENSOR_HEALTH shows it.
bool loses_some(const SentCount& sent, HostTime now) {
    constexpr double kSome = 0.2;
    const auto is_some = [](const std::optional<SentCount::Loss>& loss) {
        return loss && loss->lost > SentCount::kOnTheWay && loss->is_over(kSome);
    };
    return is_some(sent.newest_loss(now, 1)) || is_some(sent.newest_loss(now));
}

/// Mostly lost, and still so: in the newest step it loses half of that share.
bool is_mostly_lost(const SentCount& sent, HostTime now) {
    const auto loss = sent.newest_loss(now);
    return loss && loss->is_over(kMostlyLost) && sent.newest_loss(now, 1)->is_over(kMostlyLost / 2);
}

/// A single reading that arrives by chance is no sign, nor is a slow sensor's reading that was on its way
/// when all sensors fell silent.
Comes are_readings_of(const Look& other, const Look& silent, HostTime now) {
    constexpr Nanoseconds kSure{1'000'000'000};
    const Stretch& arrivals = other.record.arrivals;
    const auto& newest = arrivals.newest();
    const Nanoseconds break_after = SensorRecord::break_after(other.period);
    if (other.what != SensorSilence::none || !newest || now - *newest > break_after) return Comes::no;
    if (silent.what == SensorSilence::mostly_lost) {
        const bool is_well = arrivals.length() >= kSure && !loses_some(other.record.sent, now);
        return is_well ? Comes::yes : Comes::no;
    }
    const auto& before = silent.record.arrivals.newest();
    const bool is_later = !before || *newest - *before > SensorRecord::break_after(silent.period);
    return is_later && arrivals.length() >= kSure ? Comes::yes : Comes::unclear;
}

Comes comes_of(const Look& other, const Look& silent, HostTime now) {
    return silent.what == SensorSilence::unheard ? are_words_of(other.record, silent.record, now)
                                                 : are_readings_of(other, silent, now);
}

Comes comes_of_others(const std::vector<Look>& looks, const Look& silent, HostTime now) {
    Comes most = Comes::no;
    for (const Look& other : looks) most = std::max(most, comes_of(other, silent, now));
    return most;
}

/// `unheard` holds for all if it holds for one; of the two kinds of lost readings, the lesser holds for all.
SensorSilence of_both(SensorSilence some, SensorSilence others) {
    const bool is_first = some == SensorSilence::none;
    const bool is_unheard = some == SensorSilence::unheard || others == SensorSilence::unheard;
    return is_first || is_unheard ? std::max(some, others) : std::min(some, others);
}

std::vector<Look> look_at(const RangeGate& ranges, const HostNode& node, HostTime now) {
    std::vector<Look> looks;
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        const SensorRecord& record = ranges.record(node.node_id, static_cast<std::uint8_t>(i));
        const Nanoseconds period{node.sensors[i].period};
        looks.push_back({record, period, silence_of(record, period, now)});
    }
    return looks;
}

}  // namespace

bool is_unheard(const SensorRecord& sensor, std::optional<HostTime> now) {
    const auto& newest = sensor.words.newest();
    return now && newest && *now - *newest >= SensorRecord::kUnheardAfter;
}

SensorSilence silence_of(const SensorRecord& sensor, Nanoseconds period, HostTime now) {
    constexpr Nanoseconds kSilent{1'000'000'000};
    // a health message may overtake readings on a bus that was interrupted
    constexpr Nanoseconds kOvertaken{200'000'000};
    if (is_unheard(sensor, now)) return SensorSilence::unheard;
    const bool is_ranging = sensor.health && sensor.health->state == wire::SensorState::ranging;
    const auto& newest = sensor.arrivals.newest();
    const bool is_recent = newest && now - *newest < std::max(kSilent, 3 * period);
    const bool is_silent =
        is_ranging && !is_recent && sensor.sent.are_missing(now, std::max(kOvertaken, 2 * period));
    if (is_silent) return SensorSilence::no_readings;
    return is_mostly_lost(sensor.sent, now) ? SensorSilence::mostly_lost : SensorSilence::none;
}

NodeSilence silence_of(const RangeGate& ranges, const HostNode& node, HostTime now) {
    const std::vector<Look> looks = look_at(ranges, node, now);
    NodeSilence silence;
    for (std::size_t i = 0; i < looks.size(); ++i) {
        const Look& silent = looks[i];
        if (silent.what == SensorSilence::none) continue;
        const Comes of_others = comes_of_others(looks, silent, now);
        if (of_others == Comes::yes) silence.sensors.push_back({i, silent.what});
        if (of_others == Comes::no) silence.of_all = of_both(silence.of_all, silent.what);
    }
    if (silence.of_all == SensorSilence::none) return silence;
    std::erase_if(silence.sensors, [&](const auto& sensor) {
        return sensor.what != SensorSilence::unheard || silence.of_all == SensorSilence::unheard;
    });
    return silence;
}

}  // namespace octoskin
