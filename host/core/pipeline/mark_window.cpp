#include "host/core/pipeline/mark_window.hpp"

#include <algorithm>

namespace octoskin {
namespace {

constexpr std::size_t kWindowsMax = 16;

}  // namespace

bool MarkWindow::take(const wire::Mark& mark) {
    if (begin_ != MapBegin::start_mark) {
        return false;
    }
    const HostTime at = time_of(mark);
    const bool is_open = !windows_.empty() && !windows_.back().stop;
    if (mark.kind == wire::MarkKind::stop) {
        if (!is_open || at < windows_.back().start) {
            return false;
        }
        windows_.back().stop = at;
        return true;
    }
    if (is_open || (!windows_.empty() && at < *windows_.back().stop)) {
        return false;
    }
    if (windows_.size() == kWindowsMax) {
        windows_.erase(windows_.begin());
    }
    windows_.push_back({at, std::nullopt});
    return true;
}

bool MarkWindow::contains(HostTime captured) const {
    if (begin_ == MapBegin::first_usable) {
        return true;
    }
    return std::ranges::any_of(windows_, [&](const Window& window) {
        return captured >= window.start && (!window.stop || captured <= *window.stop);
    });
}

}  // namespace octoskin
