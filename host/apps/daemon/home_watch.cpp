#include "host/apps/daemon/home_watch.hpp"

#include <algorithm>
#include <utility>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin {

HomeWatch::HomeWatch(MapHome home, Looker looker)
    : home_(std::make_shared<MapHome>(std::move(home))), looker_(std::move(looker)) {
    newest_.where = home_->where();
}

HomeWatch::~HomeWatch() {
    // Closing the folder's lock may take as long as a check.
    if (!task_.begun()) task_.begin([home = std::exchange(home_, nullptr)] { return Look{}; });
}

void HomeWatch::ask() {
    if (!task_.begun()) task_.begin([home = home_, looker = looker_] { return looker(*home); });
}

std::optional<OpenFolder> HomeWatch::take() {
    return note(task_.take());
}

std::optional<OpenFolder> HomeWatch::look_again(Nanoseconds patience) {
    const HostTime end = monotonic_now() + patience;
    const auto left = [end] { return std::max(end - monotonic_now(), Nanoseconds{0}); };
    auto before = note(task_.wait(left()));
    ask();
    auto next = note(task_.wait(left()));
    return next ? std::move(next) : std::move(before);
}

std::optional<OpenFolder> HomeWatch::note(std::optional<Look> found) {
    if (!found) return std::nullopt;
    newest_ = std::move(*found);
    return std::exchange(newest_.next, std::nullopt);
}

HomeWatch::Look HomeWatch::look(MapHome& home) {
    Look found;
    if (home.look()) found.next = home.folder();
    found.problem = home.problem();
    found.where = home.where();
    return found;
}

}  // namespace octoskin
