#include "host/apps/daemon/problem_log.hpp"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <utility>

namespace octoskin {

void ProblemLog::tell(std::vector<Problem> problems, HostTime now) {
    log(problems, now);
    if (newest_ == problems) return;
    const std::string state = problems.empty() ? "STATUS=all is well" : "STATUS=" + problems.front().text;
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
    std::erase_if(told_, [now](const Told& told) {
        const bool is_over = now - told.seen >= kOver;
        if (is_over) spdlog::info("over: {}", told.problem.text);
        return is_over;
    });
}

}  // namespace octoskin
