#include "host/apps/daemon/problem_log.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <utility>

#include "host/core/text/printable.hpp"

namespace octoskin {

void ProblemLog::update(std::vector<Problem> problems, HostTime now, bool is_settling) {
    const auto is_hidden = [&problems](const Problem& reported) {
        return !reported.hidden_by.empty() &&
               std::ranges::find(problems, reported.hidden_by, &Problem::subject) != problems.end();
    };
    for (LoggedProblem& reported : logged_)
        if (is_settling || is_hidden(reported.problem)) reported.seen = now;
    log(problems, now);
    log_over(now);
    if (newest_ == problems) return;
    const std::string state =
        problems.empty() ? "STATUS=all is well" : "STATUS=" + printable(problems.front().text());
    (void)sd_notify(0, state.c_str());
    newest_ = std::move(problems);
}

void ProblemLog::log(const std::vector<Problem>& problems, HostTime now) {
    for (const Problem& problem : problems) {
        const auto reported = std::ranges::find_if(
            logged_, [&](const LoggedProblem& each) { return each.problem.is_same(problem); });
        if (reported == logged_.end()) {
            spdlog::warn("{}", problem.text());
            logged_.push_back({problem, now, returns_of_gone(problem)});
        } else {
            const bool was_away = now - reported->seen >= kOver;
            *reported = {problem, now, reported->returns + (was_away ? 1U : 0U)};
        }
    }
}

/// A sentence that was replaced by another one of the same subject is removed without "over".
void ProblemLog::log_over(HostTime now) {
    const auto is_over = [now](const LoggedProblem& reported) {
        return now - reported.seen >= reported.over_after();
    };
    for (const LoggedProblem& reported : logged_) {
        const bool is_replaced = std::ranges::any_of(logged_, [&](const LoggedProblem& other) {
            return !is_over(other) && !other.problem.subject.empty() &&
                   other.problem.subject == reported.problem.subject;
        });
        if (!is_over(reported)) continue;
        if (!is_replaced) {
            const std::string often = reported.returns > kFreeReturns
                                          ? fmt::format(" (it came and went {} times)", reported.returns + 1)
                                          : "";
            spdlog::info("over: {}{}", reported.problem.text(), often);
        }
        gone_.push_back(reported);
    }
    std::erase_if(logged_, is_over);
    forget_old(now);
}

/// How often a problem that appears has come back by now. Removes it from the gone ones.
unsigned ProblemLog::returns_of_gone(const Problem& problem) {
    const auto gone =
        std::ranges::find_if(gone_, [&](const LoggedProblem& each) { return each.problem.is_same(problem); });
    if (gone == gone_.end()) return 0;
    const unsigned returns = gone->returns + 1;
    gone_.erase(gone);
    return returns;
}

void ProblemLog::forget_old(HostTime now) {
    std::erase_if(gone_, [now](const LoggedProblem& gone) { return now - gone.seen >= kForgotten; });
    if (gone_.size() > kGoneMax) gone_.erase(gone_.begin(), gone_.end() - kGoneMax);
}

Nanoseconds ProblemLog::LoggedProblem::over_after() const {
    constexpr unsigned kDoublingsMax = 8;  // 2 s to over kOverMax
    const unsigned doublings = std::min(returns - std::min(returns, kFreeReturns), kDoublingsMax);
    return std::min(kOver * (1 << doublings), kOverMax);
}

}  // namespace octoskin
