// Problems in the log and in the service manager's status: logged when they appear, and when they are gone
// for good.
#pragma once

#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/problem.hpp"

namespace octoskin {

class ProblemLog {
  public:
    /// A problem is over in the log when it was absent for this long, so that one that comes and goes counts
    /// as one.
    static constexpr Nanoseconds kOver{2'000'000'000};
    /// A problem that has come back this often must be absent for twice as long each time, up to kOverMax: a
    /// line for each of its returns would hide the others. When it is over, the log contains how often it
    /// came and went.
    static constexpr unsigned kFreeReturns = 2;
    static constexpr Nanoseconds kOverMax{300'000'000'000};
    /// After this long without it, it counts as a new problem.
    static constexpr Nanoseconds kForgotten{600'000'000'000};

    /// `problems`: all that exist now. While `is_settling`, some cannot be judged, and no reported problem is
    /// over.
    void update(std::vector<Problem> problems, HostTime now, bool is_settling = false);

  private:
    struct LoggedProblem {
        Problem problem;
        HostTime seen;         ///< when it was last there
        unsigned returns = 0;  ///< after it was absent for kOver
        [[nodiscard]] Nanoseconds over_after() const;
    };
    void log(const std::vector<Problem>& problems, HostTime now);
    void log_over(HostTime now);

    [[nodiscard]] unsigned returns_of_gone(const Problem& problem);
    void forget_old(HostTime now);

    static constexpr std::size_t kGoneMax = 256;
    std::vector<LoggedProblem> logged_;
    std::vector<LoggedProblem> gone_;  ///< in the order of their ends
    std::vector<Problem> newest_;
};

}  // namespace octoskin
