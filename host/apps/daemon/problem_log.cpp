#include "host/apps/daemon/problem_log.hpp"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <utility>

namespace octoskin {
namespace {

bool has(const std::vector<Problem>& problems, const Problem& problem) {
    return std::ranges::find(problems, problem.about, &Problem::about) != problems.end();
}

}  // namespace

void ProblemLog::tell(std::vector<Problem> problems) {
    for (const Problem& problem : problems)
        if (!has(told_, problem)) spdlog::warn("{}", problem.text);
    for (const Problem& problem : told_)
        if (!has(problems, problem)) spdlog::info("over: {}", problem.text);
    if (problems != told_) {
        const std::string state = problems.empty() ? "STATUS=all is well" : "STATUS=" + problems.front().text;
        (void)sd_notify(0, state.c_str());
    }
    told_ = std::move(problems);
}

}  // namespace octoskin
