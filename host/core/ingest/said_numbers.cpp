#include "host/core/ingest/said_numbers.hpp"

#include <chrono>

namespace octoskin {

SaidNumbers::Fate SaidNumbers::compare(const wire::RangeReading& reading, HostTime now,
                                       Nanoseconds turn_min) {
    std::optional<Said>& said = said_.at(reading.sequence);
    if (!said || std::chrono::abs(now - said->came) >= turn_min) {
        return Fate::is_new;
    }
    if (reading == said->reading || reading == said->other) {
        return Fate::same;
    }
    said->other = reading;
    return Fate::other;
}

void SaidNumbers::take(const wire::RangeReading& reading, HostTime now) {
    said_.at(reading.sequence) = Said{reading, now, std::nullopt};
}

}  // namespace octoskin
