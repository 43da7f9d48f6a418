// Problems in the log and in the service manager's status: each when it comes, and when it goes.
#pragma once

#include <string>
#include <vector>

namespace octoskin {

struct Problem {
    /// What is wrong with what: the same as long as the problem is, whatever figures its text has.
    std::string about;
    std::string text;  ///< a sentence for a person
    friend bool operator==(const Problem&, const Problem&) = default;
};

class ProblemLog {
  public:
    /// All that there are now.
    void tell(std::vector<Problem> problems);

  private:
    std::vector<Problem> told_;
};

}  // namespace octoskin
