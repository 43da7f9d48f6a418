#include "hw/sim/data_ready/simulated_data_ready_lines.hpp"

#include <utility>

namespace octoskin::sim {

void SimulatedDataReadyLines::look(SimTime now) {
    for (std::size_t bus = 0; bus < lines_.size(); ++bus) {
        const bool is_high = lines_[bus].is_high(now);
        const bool has_chattered = lines_[bus].fault() == LineFault::chatters && now.us > looked_.us + 1;
        if ((was_high_[bus] && !is_high) || has_chattered) has_fallen_[bus] = true;
        was_high_[bus] = is_high;
    }
    looked_ = now;
}

/// A chattering line is sampled once per turn of the board's loop: simulating each edge would be too slow.
std::optional<SimTime> SimulatedDataReadyLines::next_change(SimTime now) const {
    constexpr std::int64_t kLoopUs = 50;
    std::optional<SimTime> next;
    for (const DataReadyLine& line : lines_) {
        auto change = line.next_change(now);
        if (line.fault() == LineFault::chatters) change = SimTime{now.us + kLoopUs};
        if (change && (!next || *change < *next)) next = change;
    }
    return next;
}

bool SimulatedDataReadyLines::take_fall(std::uint8_t bus) {
    ++asked_.at(bus);
    return std::exchange(has_fallen_.at(bus), false);
}

}  // namespace octoskin::sim
