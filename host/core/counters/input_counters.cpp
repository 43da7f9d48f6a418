#include "host/core/counters/input_counters.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <iomanip>
#include <sstream>

namespace octoskin {

std::string seconds_text(std::int64_t ns) {
    const auto us = std::chrono::floor<std::chrono::microseconds>(std::chrono::nanoseconds(ns)).count();
    return fmt::format("{}{}.{:06} s", us < 0 ? "-" : "", std::abs(us) / 1'000'000, std::abs(us) % 1'000'000);
}

std::string to_text(const CounterTable& table) {
    std::uint64_t rejected = 0;
    for (const CounterTable::Row& row : table.rejected) {
        rejected += row.count;
    }
    std::ostringstream text;
    text << std::left << std::setw(22) << table.title() << std::right << std::setw(10) << table.in
         << " in = " << table.used << " used + " << rejected << " rejected";
    if (table.pending > 0) {
        text << " + " << table.pending << " pending";
    }
    text << (table.is_balanced ? "\n" : "   NOT BALANCED\n");
    for (const CounterTable::Row& row : table.rejected) {
        if (row.count > 0) {
            text << "  " << std::left << std::setw(28) << row.name << std::right << std::setw(10) << row.count
                 << "\n";
        }
    }
    return text.str();
}

}  // namespace octoskin
