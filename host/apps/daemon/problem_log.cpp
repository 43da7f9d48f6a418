#include "host/apps/daemon/problem_log.hpp"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <utility>

#include "host/core/text/printable.hpp"

namespace octoskin {

void ProblemLog::tell(std::vector<Problem> problems, HostTime now, bool is_settling) {
    const auto is_hidden = [&problems](const Problem& told) {
        return !told.hidden_by.empty() &&
               std::ranges::find(problems, told.hidden_by, &Problem::subject) != problems.end();
    };
    for (Told& told : told_)
        if (is_settling || is_hidden(told.problem)) told.seen = now;
    log(problems, now);
    log_over(now);
    if (newest_ == problems) return;
    const std::string state =
        problems.empty() ? "STATUS=all is well" : "STATUS=" + printable(problems.front().text);
    (void)sd_notify(0, state.c_str());
    newest_ = std::move(problems);
}

void ProblemLog::log(const std::vector<Problem>& problems, HostTime now) {
    for (const Problem& problem : problems) {
        const auto told = std::ranges::find(
            told_, problem.about, [](const Told& each) -> const std::string& { return each.problem.about; });
        if (told == told_.end()) {
            spdlog::warn("{}", problem.text);
            told_.push_back({problem, now});
        } else {
            *told = {problem, now};
        }
    }
}

/// A sentence that another of the same subject has replaced is no more, and nothing is over.
void ProblemLog::log_over(HostTime now) {
    const auto is_over = [now](const Told& told) { return now - told.seen >= kOver; };
    for (const Told& told : told_) {
        const bool is_replaced = std::ranges::any_of(told_, [&](const Told& other) {
            return !is_over(other) && !other.problem.subject.empty() &&
                   other.problem.subject == told.problem.subject;
        });
        if (is_over(told) && !is_replaced) spdlog::info("over: {}", told.problem.text);
    }
    std::erase_if(told_, is_over);
}

}  // namespace octoskin
