// Wall and CPU time of one part of the work, measured on the thread that does it.
#pragma once

#include <ctime>

#include "host/lab/evaluation/results.hpp"

namespace octoskin {

class PartTimer {
  public:
    explicit PartTimer(std::string part) : part_(std::move(part)) {}

    [[nodiscard]] evaluation::PartTime stop() const {
        return {part_, seconds(CLOCK_MONOTONIC) - wall_, seconds(CLOCK_THREAD_CPUTIME_ID) - cpu_};
    }

  private:
    static double seconds(clockid_t clock) {
        timespec now{};
        clock_gettime(clock, &now);
        return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
    }

    std::string part_;
    double wall_ = seconds(CLOCK_MONOTONIC);
    double cpu_ = seconds(CLOCK_THREAD_CPUTIME_ID);
};

}  // namespace octoskin
