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
    friend bool operator==(const Problem&, const Problem&) = default;
};

class ProblemLog {
  public:
    /// A problem is over in the log when it was not there for so long: one that comes and goes is one.
    static constexpr Nanoseconds kOver{2'000'000'000};

    /// All that there are now.
    void tell(std::vector<Problem> problems, HostTime now);

  private:
    struct Told {
        Problem problem;
        HostTime seen;  ///< the newest time that it was there
    };
    void log(const std::vector<Problem>& problems, HostTime now);

    std::vector<Told> told_;
    std::vector<Problem> newest_;
};

}  // namespace octoskin
