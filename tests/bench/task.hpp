// What a row of the bench measures.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/figures.hpp"

namespace octoskin::bench {

class Task {
  public:
    virtual ~Task() = default;
    /// Makes ready what the next run needs that is not part of it.
    virtual void prepare() {}
    virtual void run() = 0;
    /// After the last run: all figures but the times.
    virtual void tell(Figures&) const {}
};

struct Row {
    std::string name;
    std::string peer;  ///< the row it is compared with, OctoMap's mostly; empty if there is none
    unsigned runs = 0;
    /// Called only for a row that is asked for; what it makes may take long.
    std::function<std::unique_ptr<Task>()> make;
    bool is_by_clock = false;  ///< in place of the processors' time: threads work at once
};

}  // namespace octoskin::bench
