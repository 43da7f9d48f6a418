#include <fmt/format.h>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/problems/problem_groups.hpp"

namespace octoskin {

void add_log(const DaemonView& view, Problems& problems) {
    constexpr Nanoseconds kStuck{3'000'000'000};
    const LogRecord& log = view.log;
    if (!log.stuck_since || view.now - *log.stuck_since < kStuck) return;
    problems.push_back(
        {.code = ProblemCode::log_stuck,
         .what = fmt::format("the log has taken no line for {:.0f} s: its reader (a pager, a terminal with "
                             "Ctrl-S, a pipe, the journal) has stopped; {} lines wait, {} were dropped; "
                             "mapping continues",
                             seconds_of(view.now - *log.stuck_since), log.waiting, log.dropped)});
}

}  // namespace octoskin
