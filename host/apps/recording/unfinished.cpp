#include "host/apps/recording/unfinished.hpp"

#include <map>
#include <set>
#include <system_error>
#include <utility>

namespace octoskin {
namespace {

namespace fs = std::filesystem;

/// The whole process has one: a signal is told to all of it.
struct Registry {
    std::mutex mutex;
    std::multimap<fs::path, fs::path> folders;  ///< with what was made for them
};

Registry& registry() {
    static Registry one;
    return one;
}

void forget(const fs::path& folder) {
    auto& folders = registry().folders;
    if (const auto found = folders.find(folder); found != folders.end()) folders.erase(found);
}

/// A thread that is still at work may add a file between two looks.
void clear_away(const fs::path& folder) {
    constexpr int kTries = 10;
    std::error_code error;
    for (int i = 0; i < kTries && fs::exists(fs::symlink_status(folder, error)); ++i)
        fs::remove_all(folder, error);
}

}  // namespace

Unfinished::Unfinished(fs::path folder, fs::path made_for_it)
    : folder_(std::move(folder)), made_for_it_(std::move(made_for_it)) {
    const std::lock_guard lock(registry().mutex);
    registry().folders.emplace(folder_, made_for_it_);
}

Unfinished::Unfinished(Unfinished&& other) noexcept
    : folder_(std::exchange(other.folder_, {})), made_for_it_(std::exchange(other.made_for_it_, {})) {}

Unfinished::~Unfinished() {
    if (!folder_.empty()) (void)finish();
}

std::unique_lock<std::mutex> Unfinished::finish() {
    std::unique_lock lock(registry().mutex);
    if (!folder_.empty()) forget(std::exchange(folder_, {}));
    return lock;
}

RemovedUnfinished remove_unfinished() {
    RemovedUnfinished removed{.is_any = false, .lock = std::unique_lock(registry().mutex)};
    const auto& folders = registry().folders;
    removed.is_any = !folders.empty();
    std::set<fs::path> made;
    for (const auto& [folder, made_for_it] : folders) {
        clear_away(folder);
        if (!made_for_it.empty()) made.insert(made_for_it);
    }
    std::error_code ignored;
    // What lies in another comes after it: only an empty one goes.
    for (auto folder = made.rbegin(); folder != made.rend(); ++folder) fs::remove(*folder, ignored);
    return removed;
}

}  // namespace octoskin
