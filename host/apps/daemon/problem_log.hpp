// Problems in the log and in the service manager's status: each when it comes, and when it goes.
#pragma once

#include <string>
#include <vector>

namespace octoskin {

class ProblemLog {
  public:
    /// All that there are now.
    void tell(std::vector<std::string> problems);

  private:
    std::vector<std::string> told_;
};

}  // namespace octoskin
