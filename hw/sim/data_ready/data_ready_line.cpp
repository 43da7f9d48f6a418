#include "hw/sim/data_ready/data_ready_line.hpp"

#include <algorithm>

namespace octoskin::sim {

bool DataReadyLine::is_high(SimTime time) const {
    switch (fault_) {
        case LineFault::stuck_low:
            return false;
        case LineFault::stuck_high:
            return true;
        case LineFault::chatters:
            return time.us % 2 == 0;
        case LineFault::none:
            break;
    }
    // Every sensor must be advanced to the time, also if an earlier one is already low.
    return std::ranges::count_if(sensors_,
                                 [time](SensorModel* sensor) { return !sensor->gpio1_level(time); }) == 0;
}

std::optional<SimTime> DataReadyLine::next_change(SimTime now) const {
    if (fault_ == LineFault::chatters) return SimTime{now.us + 1};
    if (fault_ != LineFault::none) return std::nullopt;
    std::optional<SimTime> next;
    for (const SensorModel* sensor : sensors_) {
        const auto event = sensor->next_event(now);
        if (event && (!next || *event < *next)) next = event;
    }
    return next;
}

}  // namespace octoskin::sim
