#include "host/apps/recording/file_set.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include "host/apps/recording/text_file.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReadyFolder = ".octoskin-ready";
constexpr const char* kBeforeFolder = ".before";  ///< in the ready folder: what the new files replace
constexpr const char* kJournal = ".journal";      ///< in the ready folder: what is to be done
constexpr const char* kJournalHead = "octoskin-file-set/1";

Unexpected<AppError> busy(const fs::path& folder) {
    return cannot_create(
        folder, "another octoskin is writing here; wait until it has ended, or give another directory");
}

Unexpected<AppError> cannot_write(const fs::path& folder, const std::error_code& error) {
    return cannot_create(folder,
                         "nothing can be written there (" + error.message() + "): " + remedy_of(error));
}

bool is_there(const fs::path& path) {
    std::error_code error;
    return fs::exists(fs::symlink_status(path, error));
}

/// What to do, in the order in which it is done; `put` ends with the file that vouches for all.
struct Journal {
    std::vector<fs::path> drop;
    std::vector<fs::path> put;
};

/// Stays in the folder, and is one of ours to touch.
bool is_within(const fs::path& name) {
    return !name.empty() && name.is_relative() &&
           std::none_of(name.begin(), name.end(), [](const fs::path& part) { return part == ".."; });
}

Status<AppError> write_journal(const fs::path& file, const Journal& journal) {
    std::ofstream out(file, std::ios::binary);
    out << kJournalHead << '\n';
    for (const fs::path& name : journal.drop) out << "drop " << name.string() << '\n';
    for (const fs::path& name : journal.put) out << "put " << name.string() << '\n';
    out.close();
    if (!out) return cannot_create(file, "cannot write; is the disk full?");
    return Done{};
}

Result<Journal, AppError> read_journal(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    Journal journal;
    std::string line;
    bool is_sound = std::getline(in, line) && line == kJournalHead;
    while (is_sound && std::getline(in, line)) {
        const auto space = line.find(' ');
        const fs::path name = space == std::string::npos ? "" : line.substr(space + 1);
        const std::string verb = line.substr(0, space);
        is_sound = is_within(name) && (verb == "put" || verb == "drop");
        (verb == "put" ? journal.put : journal.drop).push_back(name);
    }
    if (!is_sound || journal.put.empty()) {
        return cannot_create(file, "is not what octoskin writes; remove " + file.parent_path().string() +
                                       " and make the files beside it again");
    }
    return journal;
}

/// A file or a folder, to the disk.
Status<AppError> flush(const fs::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool is_flushed = descriptor >= 0 && ::fsync(descriptor) == 0;
    const std::string reason = std::generic_category().message(errno);
    if (descriptor >= 0) ::close(descriptor);
    if (!is_flushed) return cannot_create(path, "cannot be flushed to the disk (" + reason + ")");
    return Done{};
}

Status<AppError> move(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::rename(from, to, error);
    if (error) return cannot_create(to, error.message());
    return Done{};
}

/// That a place is free, or taken by a file that can be replaced.
Status<AppError> check_place(const fs::path& place) {
    std::error_code error;
    const auto status = fs::status(place, error);
    if (!fs::exists(status) || fs::is_regular_file(status)) return Done{};
    return cannot_create(place,
                         "is no file, and one of this name is to be put there or removed; move it away");
}

/// The steps between the ready folder and the folder. Each looks at what is there, so that it can be begun
/// again after any of them.
class Move {
  public:
    Move(fs::path folder, Journal journal)
        : folder_(std::move(folder)), ready_(folder_ / kReadyFolder), journal_(std::move(journal)) {}

    Status<AppError> forward() {
        // The decision reaches the disk before anything that follows from it.
        if (const auto flushed = flush(folder_); !flushed) return flushed;
        // The former set loses its voucher first.
        if (const auto kept = keep(journal_.put.back(), Keep::moved); !kept) return kept;
        for (const fs::path& name : journal_.drop) {
            if (const auto kept = keep(name, Keep::moved); !kept) return kept;
        }
        for (const fs::path& name : journal_.put) {
            if (!is_there(ready_ / name)) continue;
            if (const auto kept = keep(name, Keep::linked); !kept) return kept;
            if (const auto moved = move(ready_ / name, folder_ / name); !moved) return moved;
        }
        return flush(folder_);
    }

    /// New files back into the ready folder, then the former ones into their places; those that vouch go
    /// first and come last.
    Status<AppError> back() {
        for (auto name = journal_.put.rbegin(); name != journal_.put.rend(); ++name) {
            if (is_there(ready_ / *name)) continue;
            if (const auto moved = move(folder_ / *name, ready_ / *name); !moved) return moved;
        }
        std::vector<fs::path> all = journal_.drop;
        all.insert(all.end(), journal_.put.begin(), journal_.put.end());
        for (const fs::path& name : all) {
            const fs::path former = ready_ / kBeforeFolder / name;
            if (!is_there(former)) continue;
            if (const auto moved = move(former, folder_ / name); !moved) return moved;
        }
        return Done{};
    }

    /// Some new file is in its place, or some former one is not.
    [[nodiscard]] bool has_moved() const {
        const auto is_away = [this](const fs::path& name) {
            return is_there(ready_ / kBeforeFolder / name) || (is_put(name) && !is_there(ready_ / name));
        };
        return std::any_of(journal_.drop.begin(), journal_.drop.end(), is_away) ||
               std::any_of(journal_.put.begin(), journal_.put.end(), is_away);
    }

    void remove_ready() const {
        // The name goes first: half of a ready folder must not look like a whole one.
        const fs::path draft = folder_ / FileSet::kDraftFolder;
        std::error_code ignored;
        fs::remove_all(draft, ignored);
        fs::rename(ready_, draft, ignored);
        fs::remove_all(draft, ignored);
    }

  private:
    enum class Keep : std::uint8_t { moved, linked };

    /// Keeps the file that is in the place of `name`, so that it can be had back. A link leaves it there
    /// until the new one takes its place; where links are not to be had, it is moved away a moment before.
    Status<AppError> keep(const fs::path& name, Keep how) {
        const fs::path former = ready_ / kBeforeFolder / name;
        // A new file that is in place already is none to keep.
        const bool is_done = is_there(former) || (is_put(name) && !is_there(ready_ / name));
        if (is_done || !is_there(folder_ / name)) return Done{};
        if (const auto checked = check_place(folder_ / name); !checked) return checked;
        std::error_code error;
        fs::create_directories(former.parent_path(), error);
        if (error) return cannot_create(former.parent_path(), error.message());
        if (how == Keep::linked && ::link((folder_ / name).c_str(), former.c_str()) == 0) return Done{};
        return move(folder_ / name, former);
    }

    bool is_put(const fs::path& name) const {
        return std::find(journal_.put.begin(), journal_.put.end(), name) != journal_.put.end();
    }

    fs::path folder_;
    fs::path ready_;
    Journal journal_;
};

/// From a ready folder to files in their places; or, with an error, to the folder as it was, with the ready
/// folder still in it.
Status<AppError> carry_out(Move& moving) {
    auto moved = moving.forward();
    if (moved) {
        moving.remove_ready();
        return Done{};
    }
    if (const auto undone = moving.back(); !undone)
        return fail(
            ExitCode::cannot_create,
            undone.error().message + ": taking back what was moved failed, after " + moved.error().message);
    return moved;
}

Status<AppError> finish_interrupted(const fs::path& folder) {
    const fs::path ready = folder / kReadyFolder;
    if (!is_there(ready)) return Done{};
    const auto journal = read_journal(ready / kJournal);
    if (!journal) return unexpected(journal.error());
    Move moving(folder, *journal);
    if (const auto moved = carry_out(moving); !moved) {
        return fail(ExitCode::cannot_create, moved.error().message +
                                                 "; the files of a run that was killed wait in " +
                                                 ready.string() + ": try again after that, or remove them");
    }
    return Done{};
}

}  // namespace

FileSet::FileSet(fs::path folder, bool is_new, FileLock lock)
    : folder_(std::move(folder)),
      draft_(folder_ / kDraftFolder),
      is_new_(is_new),
      unfinished_(draft_, is_new ? folder_ : fs::path()),
      lock_(std::move(lock)) {}

FileSet::FileSet(FileSet&& other) noexcept
    : folder_(std::move(other.folder_)),
      draft_(std::move(other.draft_)),
      is_new_(other.is_new_),
      is_open_(std::exchange(other.is_open_, false)),
      unfinished_(std::move(other.unfinished_)),
      lock_(std::move(other.lock_)) {}

FileSet::~FileSet() {
    if (!is_open_) return;
    std::error_code ignored;
    fs::remove_all(draft_, ignored);
    if (is_new_) fs::remove(folder_, ignored);  // only if it is empty
}

Result<FileSet, AppError> FileSet::begin(const fs::path& folder) {
    std::error_code error;
    const bool is_new = fs::create_directories(folder, error);
    if (error) return cannot_write(folder, error);
    auto lock = FileLock::take(folder, FileLock::Kind::exclusive);
    if (!lock) return busy(folder);
    if (const auto finished = finish_interrupted(folder); !finished) return unexpected(finished.error());
    FileSet set(folder, is_new, std::move(*lock));
    fs::remove_all(set.draft_, error);  // of a process that was killed
    fs::create_directory(set.draft_, error);
    if (error) return cannot_write(folder, error);
    return set;
}

Status<AppError> FileSet::commit(const std::vector<fs::path>& files, const std::vector<fs::path>& retired) {
    assert(!files.empty() && std::all_of(retired.begin(), retired.end(), is_within));
    for (const auto& names : {files, retired}) {
        for (const fs::path& name : names) {
            if (const auto checked = check_place(folder_ / name); !checked) return checked;
        }
    }
    const Journal journal{retired, files};
    if (const auto written = write_journal(draft_ / kJournal, journal); !written) return written;
    for (const fs::path& file : files) {
        if (const auto flushed = flush(draft_ / file); !flushed) return flushed;
    }
    for (const fs::path& last : {draft_ / kJournal, draft_}) {
        if (const auto flushed = flush(last); !flushed) return flushed;
    }
    const auto whole = unfinished_.finish();
    if (const auto decided = move(draft_, folder_ / kReadyFolder); !decided) return decided;
    is_open_ = false;
    Move moving(folder_, journal);
    auto moved = carry_out(moving);
    if (!moved && !moving.has_moved()) moving.remove_ready();
    return moved;
}

Status<AppError> settle_file_set(const fs::path& folder) {
    if (!is_there(folder / kReadyFolder)) return Done{};
    const auto lock = FileLock::take(folder, FileLock::Kind::exclusive);
    if (!lock) return busy(folder);
    return finish_interrupted(folder);
}

}  // namespace octoskin
