#include "host/core/ingest/rate_limit.hpp"

#include <algorithm>
#include <cassert>

namespace octoskin {

RateLimit::RateLimit(std::size_t per_second) : times_(per_second) {
    assert(per_second > 0);
}

bool RateLimit::keeps_with_event(HostTime at) {
    constexpr Nanoseconds kSecond{1'000'000'000};
    if (taken_ > 0 && newest_ - at >= kSecond) {
        taken_ = 0;
        next_ = 0;
    }
    newest_ = taken_ > 0 ? std::max(at, newest_) : at;
    HostTime& oldest = times_[next_];
    const bool is_kept = taken_ < times_.size() || newest_ - oldest >= kSecond;
    oldest = newest_;
    next_ = (next_ + 1) % times_.size();
    taken_ += taken_ < times_.size() ? 1U : 0U;
    return is_kept;
}

}  // namespace octoskin
