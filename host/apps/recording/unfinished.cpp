#include "host/apps/recording/unfinished.hpp"

#include <unistd.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace octoskin {
namespace {

struct Entry {
    OpenFolder parent;
    std::string name;
    bool is_parent_new;
};

/// One for the whole process: a signal concerns all of its threads.
struct Registry {
    std::mutex mutex;
    std::map<std::uint64_t, Entry> entries;
    std::uint64_t newest = 0;
};

Registry& registry() {
    static Registry one;
    return one;
}

/// A thread that still works may add a file between two attempts.
void clear_away(const Entry& entry) {
    constexpr int kTries = 10;
    for (int i = 0; i < kTries && entry.parent.kind_of(entry.name) != EntryKind::absent; ++i)
        static_cast<void>(entry.parent.remove_all(entry.name));
}

}  // namespace

Unfinished::Unfinished(OpenFolder parent, std::string name, bool is_parent_new) {
    const std::lock_guard lock(registry().mutex);
    number_ = ++registry().newest;
    registry().entries.emplace(number_, Entry{std::move(parent), std::move(name), is_parent_new});
}

Unfinished::Unfinished(Unfinished&& other) noexcept : number_(std::exchange(other.number_, 0)) {}

Unfinished::~Unfinished() {
    if (number_ != 0) (void)finish();
}

std::unique_lock<std::mutex> Unfinished::finish() {
    std::unique_lock lock(registry().mutex);
    registry().entries.erase(std::exchange(number_, 0));
    return lock;
}

RemovedUnfinished remove_unfinished() {
    RemovedUnfinished removed{.is_any = false, .lock = std::unique_lock(registry().mutex)};
    const auto& entries = registry().entries;
    removed.is_any = !entries.empty();
    std::vector<OpenFolder> made;
    for (const auto& [number, entry] : entries) {
        clear_away(entry);
        if (entry.is_parent_new) made.push_back(entry.parent);
    }
    // A nested folder comes before its parent: only an empty folder is removed.
    std::sort(made.begin(), made.end(),
              [](const OpenFolder& one, const OpenFolder& other) { return one.shown() > other.shown(); });
    for (const OpenFolder& folder : made) remove_made_folder(folder);
    return removed;
}

void remove_made_folder(const OpenFolder& folder) {
    if (folder.is_still_there()) ::rmdir(folder.shown().c_str());
}

}  // namespace octoskin
