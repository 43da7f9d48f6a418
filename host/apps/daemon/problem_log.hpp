// Problems in the log and in the service manager's status: each when it comes, and when it has gone for good.
#pragma once

#include <string>
#include <vector>

#include "common/time.hpp"

namespace octoskin {

struct Problem {
    /// What is wrong with what: the same as long as the problem is, whatever figures its text has.
    std::string about;
    std::string text;  ///< a sentence for a person
    /// Whose problem it is, where another sentence may take this one's place; else empty.
    std::string subject = {};
    /// Whose problem hides this one: while there is one of that subject, nobody can tell whether this is
    /// over.
    std::string hidden_by = {};
    friend bool operator==(const Problem&, const Problem&) = default;
};

class ProblemLog {
  public:
    /// A problem is over in the log when it was not there for so long: one that comes and goes is one.
    static constexpr Nanoseconds kOver{2'000'000'000};
    /// One that comes back so often must then be away for twice as long each time, up to kOverMax: a line for
    /// each of its turns would hide the others. Once it is over, the log says how often it came and went.
    static constexpr unsigned kFreeReturns = 2;
    static constexpr Nanoseconds kOverMax{300'000'000'000};
    /// After so long without it, it is one that never was.
    static constexpr Nanoseconds kForgotten{600'000'000'000};

    /// All that there are now; while `is_settling` some cannot be judged, and none that was told is over.
    void tell(std::vector<Problem> problems, HostTime now, bool is_settling = false);

  private:
    struct Told {
        Problem problem;
        HostTime seen;         ///< the newest time that it was there
        unsigned returns = 0;  ///< after it was away for kOver
        [[nodiscard]] Nanoseconds over_after() const;
    };
    void log(const std::vector<Problem>& problems, HostTime now);
    void log_over(HostTime now);

    [[nodiscard]] unsigned returns_of_gone(const Problem& problem);
    void forget_old(HostTime now);

    static constexpr std::size_t kGoneMax = 256;
    std::vector<Told> told_;
    std::vector<Told> gone_;  ///< in the order of their ends
    std::vector<Problem> newest_;
};

}  // namespace octoskin
