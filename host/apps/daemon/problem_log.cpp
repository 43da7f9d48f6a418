#include "host/apps/daemon/problem_log.hpp"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <utility>

namespace octoskin {
namespace {

/// A number in a sentence may grow: it is the same problem.
std::string without_numbers(std::string problem) {
    std::erase_if(problem, [](char letter) { return letter >= '0' && letter <= '9'; });
    return problem;
}

bool has(const std::vector<std::string>& problems, const std::string& problem) {
    return std::ranges::any_of(problems, [words = without_numbers(problem)](const std::string& other) {
        return without_numbers(other) == words;
    });
}

}  // namespace

void ProblemLog::tell(std::vector<std::string> problems) {
    for (const std::string& problem : problems)
        if (!has(told_, problem)) spdlog::warn("{}", problem);
    for (const std::string& problem : told_)
        if (!has(problems, problem)) spdlog::info("over: {}", problem);
    if (problems != told_) {
        const std::string state = problems.empty() ? "STATUS=all is well" : "STATUS=" + problems.front();
        (void)sd_notify(0, state.c_str());
    }
    told_ = std::move(problems);
}

}  // namespace octoskin
