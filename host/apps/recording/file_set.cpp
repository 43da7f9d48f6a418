#include "host/apps/recording/file_set.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "host/apps/recording/recording.hpp"
#include "host/apps/recording/text_file.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDepthFolder = RecordingPaths::kDepthFolder;
constexpr const char* kReady = FileSet::kReadyFolder;
constexpr const char* kBeforeFolder =
    ".before";                                ///< in the ready folder: the files that the new ones replace
constexpr const char* kJournal = ".journal";  ///< in the ready folder: the list of steps
constexpr const char* kJournalHead = "octoskin-file-set/1";
constexpr const char* kNotFlushed = "cannot be flushed to the disk: ";
constexpr std::size_t kJournalBytesMax = 16'384;  ///< more than the files of two recordings take
constexpr std::size_t kCameraNameMax = 32;

constexpr std::array<std::string_view, 9> kRecordingFiles{"can.log",   "depth.oni",   "depth.epoch.yaml",
                                                          "rig.yaml",  "robot.urdf",  "scenario.yaml",
                                                          "world.sdf", "motion.yaml", "meta.yaml"};
constexpr std::array<std::string_view, 10> kMapFiles{
    "depth.ot",      "depth.bt", "depth.ply", "proximity.ot", "proximity.bt",
    "proximity.ply", "fused.ot", "fused.bt",  "fused.ply",    "maps.yaml"};

Unexpected<AppError> busy(const OpenFolder& folder) {
    return cannot_create(folder.shown(), {.code = ErrorCode::in_use,
                                          .what = "another octoskin is writing here",
                                          .remedy = "wait until it ends, or give another directory"});
}

Unexpected<AppError> of_a_daemon(const OpenFolder& folder) {
    return cannot_create(folder.shown(kDaemonsSnapshot),
                         {.code = ErrorCode::already_exists,
                          .what = "belongs to a daemon's map, which is kept in this folder",
                          .remedy = "give another directory"});
}

/// Nothing is replaced or removed: either map can be the only copy.
Unexpected<AppError> beside_a_daemons_map(const OpenFolder& folder) {
    const std::string ready = folder.shown(kReady).string();
    return cannot_create(
        folder.shown(kDaemonsSnapshot),
        {.code = ErrorCode::unfinished_move,
         .what =
             "belongs to a daemon's map, and the files of a killed run wait in " + ready + " to replace it",
         .remedy = "to keep the daemon's map, move " + ready +
                   " into an empty folder, where octoskin repair completes it; to replace the map, move "
                   "fused.ot, fused.bt and fused.snapshot to another folder and run octoskin repair " +
                   folder.shown().string()});
}

Unexpected<AppError> cannot_write(const FolderError& error) {
    Error full = to_error(error);
    if (error.fault != FolderFault::foreign_owner && error.fault != FolderFault::link) {
        full.what = "nothing can be written there (" + full.what + ")";
        full.remedy = remedy_of({error.error_number, std::generic_category()});
    }
    return fail(ExitCode::cannot_create, std::move(full));
}

Unexpected<AppError> failed(const FolderError& error, const std::string& before = {}) {
    return fail(ExitCode::cannot_create, to_error(error, before));
}

bool is_there(const OpenFolder& folder, const fs::path& name) {
    return folder.kind_of(name) != EntryKind::absent;
}

/// Checks only the present: a daemon may start later.
Status<AppError> check_for_daemon(const OpenFolder& folder) {
    if (!FileLock::take(FilePlace(folder, kDaemonsLock), FileLock::Kind::exclusive)) return busy(folder);
    if (is_there(folder, kDaemonsSnapshot)) return of_a_daemon(folder);
    return Done{};
}

/// No daemon starts while the result exists.
Result<DaemonsKeptOut, AppError> keep_daemons_out(const OpenFolder& folder) {
    auto kept = DaemonsKeptOut::from(folder);
    if (!kept) return cannot_write(kept.error());
    if (!*kept) return busy(folder);
    if (is_there(folder, kDaemonsSnapshot)) return of_a_daemon(folder);
    return std::move(**kept);
}

/// The steps in their order; `put` ends with the file that marks the set as complete.
struct Journal {
    std::vector<fs::path> drop;
    std::vector<fs::path> put;
};

std::string text_of(const Journal& journal) {
    std::string text = std::string(kJournalHead) + '\n';
    for (const fs::path& name : journal.drop) text += "drop " + name.string() + '\n';
    for (const fs::path& name : journal.put) text += "put " + name.string() + '\n';
    return text;
}

/// A longer journal than this could not be read again.
Status<AppError> write_journal(const OpenFolder& draft, const fs::path& shown, const Journal& journal) {
    const std::string text = text_of(journal);
    if (text.size() > kJournalBytesMax) {
        return cannot_create(shown, {.code = ErrorCode::limit_exceeded,
                                     .what = "has too many files that are to be replaced or removed",
                                     .value = std::to_string(journal.drop.size() + journal.put.size()),
                                     .remedy = "give another directory"});
    }
    const auto created = draft.create_new(kJournal);
    if (!created) return failed(created.error());
    std::ofstream out(created->path_for_libraries(), std::ios::binary);
    out << text;
    out.close();
    if (!out) {
        return cannot_create(
            created->shown(),
            {.code = ErrorCode::system_error, .what = "cannot be written", .remedy = "is the disk full?"});
    }
    return Done{};
}

/// The journal's content comes from the owner of the folder: only names that octoskin writes are accepted.
Result<Journal, AppError> read_journal(const OpenFolder& ready) {
    const auto file = ready.open_file(kJournal);
    const auto text = file ? file->read(kJournalBytesMax) : unexpected(file.error());
    std::istringstream in(text ? *text : std::string());
    Journal journal;
    std::string line;
    bool is_sound =
        text && text->size() <= kJournalBytesMax && std::getline(in, line) && line == kJournalHead;
    while (is_sound && std::getline(in, line)) {
        const auto space = line.find(' ');
        const fs::path name = space == std::string::npos ? "" : line.substr(space + 1);
        const std::string verb = line.substr(0, space);
        is_sound = is_file_of_set(name) && (verb == "put" || verb == "drop");
        (verb == "put" ? journal.put : journal.drop).push_back(name);
    }
    if (!is_sound || journal.put.empty()) {
        return cannot_create(ready.shown(kJournal), {.code = ErrorCode::foreign_format,
                                                     .what = "is not a file that octoskin writes",
                                                     .remedy = "remove " + ready.shown().string() +
                                                               " and make the files beside it again"});
    }
    return journal;
}

Status<AppError> flush(const OpenFolder& folder) {
    if (const auto flushed = folder.flush(); !flushed) return failed(flushed.error(), kNotFlushed);
    return Done{};
}

Status<AppError> flush(const OpenFolder& folder, const fs::path& name) {
    if (const auto flushed = folder.flush(name); !flushed) return failed(flushed.error(), kNotFlushed);
    return Done{};
}

Status<AppError> move(const OpenFolder& folder, const fs::path& from, const fs::path& to) {
    if (const auto moved = folder.move(from, to); !moved) return failed(moved.error());
    return Done{};
}

/// Checks that a place is empty, or holds what is `expected`.
Status<AppError> check_kind(const OpenFolder& folder, const fs::path& name, EntryKind expected) {
    const EntryKind kind = folder.kind_of(name);
    if (kind == EntryKind::absent || kind == expected) return Done{};
    if (kind == EntryKind::link) {
        const auto opened = folder.open_file(name);
        if (!opened) return failed(opened.error());
    }
    const std::string wanted = expected == EntryKind::folder ? "folder" : "file";
    return cannot_create(folder.shown(name), {.code = ErrorCode::wrong_kind_of_file,
                                              .what = "is not a " + wanted + ", and a " + wanted +
                                                      " of this name is to be written or removed",
                                              .remedy = "move it away"});
}

bool is_in_depth_folder(const fs::path& name) {
    return name.parent_path() == kDepthFolder;
}

/// Checks that a place is empty, or holds a file that can be replaced, or the folder of depth frames.
Status<AppError> check_place(const OpenFolder& folder, const fs::path& name) {
    if (name == kDepthFolder) return check_kind(folder, name, EntryKind::folder);
    if (is_in_depth_folder(name)) {
        if (const auto checked = check_kind(folder, kDepthFolder, EntryKind::folder); !checked)
            return checked;
    }
    return check_kind(folder, name, EntryKind::file);
}

bool is_any_in_depth_folder(const std::vector<fs::path>& names) {
    return std::any_of(names.begin(), names.end(), is_in_depth_folder);
}

/// No error if it exists.
Status<AppError> make_folder(const OpenFolder& folder, const fs::path& name) {
    const auto made = folder.make_folder(name);
    if (!made && made.error().fault != FolderFault::is_there) return failed(made.error());
    return Done{};
}

/// Flushes the list of the files in a folder below `folder`.
Status<AppError> flush_folder(const OpenFolder& folder, const fs::path& name) {
    const auto opened = folder.open_folder(name);
    if (!opened) return failed(opened.error());
    return flush(*opened);
}

/// The steps from the ready folder to the final places. Each step checks the present state, so that the whole
/// can be repeated after an interruption anywhere.
class Move {
  public:
    Move(OpenFolder folder, Journal journal) : folder_(std::move(folder)), journal_(std::move(journal)) {}

    /// Before anything moves: a link, a pipe or a folder in any place stops the whole operation.
    [[nodiscard]] Status<AppError> check() const {
        for (const auto& names : {journal_.drop, journal_.put}) {
            for (const fs::path& name : names) {
                if (const auto checked = check_both(name); !checked) return checked;
            }
        }
        return Done{};
    }

    Status<AppError> forward() {
        // The decision is on the disk before anything that depends on it.
        if (const auto flushed = flush(folder_); !flushed) return flushed;
        // The previous set first loses the file that marks it as complete.
        if (const auto kept = keep(journal_.put.back(), Keep::moved); !kept) return kept;
        for (const fs::path& name : journal_.drop) {
            if (const auto kept = keep(name, Keep::moved); !kept) return kept;
        }
        for (const fs::path& name : journal_.put) {
            if (!is_there(folder_, ready(name))) continue;
            if (const auto kept = keep(name, Keep::linked); !kept) return kept;
            if (is_in_depth_folder(name)) {
                if (const auto made = make_folder(folder_, kDepthFolder); !made) return made;
            }
            if (const auto moved = move(folder_, ready(name), name); !moved) return moved;
        }
        if (const auto settled = settle_depth_folder(); !settled) return settled;
        return flush(folder_);
    }

    /// Moves new files back into the ready folder, then the previous files into their places. The files that
    /// mark a set as complete are removed first and restored last.
    Status<AppError> back() {
        for (auto name = journal_.put.rbegin(); name != journal_.put.rend(); ++name) {
            if (is_there(folder_, ready(*name)) || !is_there(folder_, *name)) continue;
            if (const auto moved = move(folder_, *name, ready(*name)); !moved) return moved;
        }
        std::vector<fs::path> all = journal_.drop;
        all.insert(all.end(), journal_.put.begin(), journal_.put.end());
        for (const fs::path& name : all) {
            if (!is_there(folder_, former(name))) continue;
            if (const auto moved = move(folder_, former(name), name); !moved) return moved;
        }
        remove_depth_folder_if_empty();
        return Done{};
    }

    /// True if a new file is in its place, or a previous one is not.
    [[nodiscard]] bool has_moved() const {
        const auto is_away = [this](const fs::path& name) {
            return is_there(folder_, former(name)) || (is_put(name) && !is_there(folder_, ready(name)));
        };
        return std::any_of(journal_.drop.begin(), journal_.drop.end(), is_away) ||
               std::any_of(journal_.put.begin(), journal_.put.end(), is_away);
    }

    void remove_ready() const {
        // Renamed first: a partly removed ready folder must not look complete.
        static_cast<void>(folder_.remove_all(FileSet::kDraftFolder));
        static_cast<void>(folder_.move(kReady, FileSet::kDraftFolder));
        static_cast<void>(folder_.remove_all(FileSet::kDraftFolder));
    }

  private:
    enum class Keep : std::uint8_t { moved, linked };

    [[nodiscard]] static fs::path ready(const fs::path& name) { return fs::path(kReady) / name; }
    [[nodiscard]] static fs::path former(const fs::path& name) {
        return fs::path(kReady) / kBeforeFolder / name;
    }
    [[nodiscard]] Status<AppError> check_both(const fs::path& name) const {
        for (const fs::path& place : {name, ready(name), former(name)}) {
            if (const auto checked = check_place(folder_, place); !checked) return checked;
        }
        return Done{};
    }

    /// Preserves the file at `name` for a rollback. A hard link leaves the file in place until the new one
    /// replaces it; on a file system without hard links it is moved away shortly before.
    Status<AppError> keep(const fs::path& name, Keep how) {
        // A new file that is already in place must not be preserved as the old one.
        const bool is_done =
            is_there(folder_, former(name)) || (is_put(name) && !is_there(folder_, ready(name)));
        if (is_done || !is_there(folder_, name)) return Done{};
        if (const auto made = make_former_folders(name); !made) return made;
        if (how == Keep::linked && folder_.link(name, former(name))) return Done{};
        return move(folder_, name, former(name));
    }

    [[nodiscard]] bool concerns_depth_folder() const {
        return is_any_in_depth_folder(journal_.drop) || is_any_in_depth_folder(journal_.put);
    }
    void remove_depth_folder_if_empty() const {
        if (concerns_depth_folder()) static_cast<void>(folder_.remove_empty(kDepthFolder));
    }
    /// Removed if it is empty, else flushed.
    [[nodiscard]] Status<AppError> settle_depth_folder() const {
        remove_depth_folder_if_empty();
        if (!concerns_depth_folder() || !is_there(folder_, kDepthFolder)) return Done{};
        return flush_folder(folder_, kDepthFolder);
    }

    Status<AppError> make_former_folders(const fs::path& name) const {
        fs::path folder = fs::path(kReady) / kBeforeFolder;
        for (const fs::path& part : name) {
            if (const auto made = make_folder(folder_, folder); !made) return made;
            folder /= part;
        }
        return Done{};
    }

    bool is_put(const fs::path& name) const {
        return std::find(journal_.put.begin(), journal_.put.end(), name) != journal_.put.end();
    }

    OpenFolder folder_;
    Journal journal_;
};

/// Moves the files of a ready folder into their places. On an error it restores the folder; the ready folder
/// is still in it.
Status<AppError> carry_out(Move& moving) {
    if (const auto checked = moving.check(); !checked) return checked;
    auto moved = moving.forward();
    if (moved) {
        moving.remove_ready();
        return Done{};
    }
    if (const auto undone = moving.back(); !undone && undone.error().message() != moved.error().message()) {
        Error error = undone.error().error;
        error.what.insert(0, "undoing the moves failed: ");
        error.others = "The first fault: " + moved.error().message();
        return fail(ExitCode::cannot_create, std::move(error));
    }
    return moved;
}

/// The error of moves that are still to be completed.
Unexpected<AppError> still_waiting(AppError app, const OpenFolder& folder) {
    Error& error = app.error;
    error.others.append(error.others.empty() ? "" : ". ")
        .append("The files of a killed run wait in " + folder.shown(kReady).string() +
                ", and may be the only copies");
    return unexpected(std::move(app));
}

/// True if there was an interrupted operation. No daemon may start meanwhile.
Result<bool, AppError> finish_interrupted(const OpenFolder& folder) {
    if (!is_there(folder, kReady)) return false;
    const auto ready = folder.open_folder(kReady);  // owned by the caller or root, like the folder itself
    if (!ready) return failed(ready.error());
    const auto journal = read_journal(*ready);
    if (!journal) return unexpected(journal.error());
    Move moving(folder, *journal);
    if (const auto moved = carry_out(moving); !moved) {
        AppError error = moved.error();
        error.error.remedy.append(error.error.remedy.empty() ? "remedy this" : "")
            .append(", then run octoskin repair " + folder.shown().string());
        return still_waiting(std::move(error), folder);
    }
    return true;
}

}  // namespace

FileSet::FileSet(OpenFolder folder, OpenFolder draft, bool is_new, Unfinished unfinished, FileLock lock)
    : folder_(std::move(folder)),
      draft_(std::move(draft)),
      is_new_(is_new),
      unfinished_(std::move(unfinished)),
      lock_(std::move(lock)) {}

FileSet::FileSet(FileSet&& other) noexcept
    : folder_(other.folder_),
      draft_(other.draft_),
      is_new_(other.is_new_),
      is_open_(std::exchange(other.is_open_, false)),
      unfinished_(std::move(other.unfinished_)),
      lock_(std::move(other.lock_)) {}

FileSet::~FileSet() {
    discard();
}

void FileSet::discard() {
    if (!std::exchange(is_open_, false)) return;
    static_cast<void>(folder_.remove_all(kDraftFolder));
    if (is_new_) remove_made_folder(folder_);
}

Result<FileSet, AppError> FileSet::begin(const FilePlace& named) {
    const auto made = named.make_folder();
    if (!made) return cannot_write(made.error());
    const OpenFolder& folder = made->folder;
    const auto give_up = [&made](Unexpected<AppError> error) {
        if (made->is_new) remove_made_folder(made->folder);
        return error;
    };
    auto lock = FileLock::take(folder, FileLock::Kind::exclusive);
    if (!lock) return busy(folder);
    if (const auto checked = check_for_daemon(folder); !checked) return unexpected(checked.error());
    if (is_there(folder, kReady)) {
        const auto daemons = keep_daemons_out(folder);
        if (!daemons) return unexpected(daemons.error());
        if (const auto finished = finish_interrupted(folder); !finished) return unexpected(finished.error());
    }
    Unfinished unfinished(folder, kDraftFolder, made->is_new);
    // An existing draft is left over from a killed process.
    if (const auto removed = folder.remove_all(kDraftFolder); !removed)
        return give_up(cannot_write(removed.error()));
    if (const auto created = folder.make_folder(kDraftFolder); !created)
        return give_up(cannot_write(created.error()));
    auto draft = folder.open_folder(kDraftFolder);
    if (!draft) return give_up(cannot_write(draft.error()));
    return FileSet(folder, std::move(*draft), made->is_new, std::move(unfinished), std::move(*lock));
}

Status<AppError> FileSet::commit(const std::vector<fs::path>& files, const std::vector<fs::path>& retired) {
    assert(!files.empty() && std::all_of(files.begin(), files.end(), is_file_of_set) &&
           std::all_of(retired.begin(), retired.end(), is_file_of_set));
    for (const auto& names : {files, retired}) {
        if (const auto checked = check_places(folder_, names); !checked) return checked;
    }
    const Journal journal{retired, files};
    if (const auto written = write_journal(draft_, folder_.shown(), journal); !written) return written;
    for (const fs::path& file : files) {
        if (const auto flushed = flush(draft_, file); !flushed) return flushed;
    }
    if (is_any_in_depth_folder(files)) {
        if (const auto flushed = flush_folder(draft_, kDepthFolder); !flushed) return flushed;
    }
    if (const auto flushed = flush(draft_, kJournal); !flushed) return flushed;
    if (const auto flushed = flush(draft_); !flushed) return flushed;
    const auto whole = unfinished_.finish();  // a signal that ends the process must not leave the lock file
    // A daemon may have started since; from here on none can.
    const auto daemons = keep_daemons_out(folder_);
    if (!daemons) {
        discard();
        return unexpected(daemons.error());
    }
    if (const auto decided = move(folder_, kDraftFolder, kReady); !decided) return decided;
    is_open_ = false;
    Move moving(folder_, journal);
    auto moved = carry_out(moving);
    if (!moved && !moving.has_moved()) moving.remove_ready();
    return moved;
}

Status<AppError> FileSet::check_places(const OpenFolder& folder, const std::vector<fs::path>& names) {
    for (const fs::path& name : names) {
        if (const auto checked = check_place(folder, name); !checked) return checked;
    }
    return Done{};
}

bool is_scene_mesh(std::string_view name) {
    constexpr std::string_view kBegin = "mesh_";
    constexpr std::size_t kDot = kBegin.size() + 2;
    constexpr std::size_t kEndingMax = 8;
    if (!name.starts_with(kBegin) || name.size() < kDot + 2 || name.size() > kDot + 1 + kEndingMax)
        return false;
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto is_small = [is_digit](char c) { return (c >= 'a' && c <= 'z') || is_digit(c); };
    return is_digit(name[kDot - 2]) && is_digit(name[kDot - 1]) && name[kDot] == '.' &&
           std::all_of(name.begin() + kDot + 1, name.end(), is_small);
}

bool is_camera_name(std::string_view name) {
    constexpr std::string_view kMarks = "_.-";
    const auto is_letter = [&](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               kMarks.find(c) != std::string_view::npos;
    };
    return !name.empty() && name.size() <= kCameraNameMax && name.front() != '.' && name.front() != '-' &&
           name.find("..") == std::string_view::npos && std::all_of(name.begin(), name.end(), is_letter);
}

std::string camera_of_file(std::string_view name) {
    for (const std::string_view ending : {".oni", ".epoch.yaml"}) {
        if (!name.ends_with(ending)) continue;
        const std::string_view camera = name.substr(0, name.size() - ending.size());
        if (is_camera_name(camera)) return std::string(camera);
    }
    return {};
}

bool is_file_of_set(const fs::path& name) {
    const std::string text = name.string();
    const auto is_in = [](const auto& list, std::string_view one) {
        return std::find(list.begin(), list.end(), one) != list.end();
    };
    constexpr std::string_view kMaps = "maps/";
    constexpr std::string_view kDepth = "depth/";
    return is_in(kRecordingFiles, text) || is_scene_mesh(text) || is_in(kMapFiles, text) ||
           (text.starts_with(kMaps) && is_in(kMapFiles, std::string_view(text).substr(kMaps.size()))) ||
           (text.starts_with(kDepth) && !camera_of_file(text.substr(kDepth.size())).empty());
}

Result<bool, AppError> settle_file_set(const OpenFolder& folder) {
    if (!is_there(folder, kReady)) return false;
    const auto lock = FileLock::take(folder, FileLock::Kind::exclusive);
    if (!lock) return busy(folder);
    if (is_there(folder, kDaemonsSnapshot)) return beside_a_daemons_map(folder);
    const auto daemons = keep_daemons_out(folder);
    if (!daemons) return still_waiting(daemons.error(), folder);
    return finish_interrupted(folder);
}

Result<bool, AppError> settle_file_set_of_daemon(const OpenFolder& folder) {
    // A process that moves files also holds the lock of daemons, which this daemon has now. The folder's lock
    // is not needed, and any user who can read the folder could hold it.
    if (!is_there(folder, kReady)) return false;
    if (is_there(folder, kDaemonsSnapshot)) return beside_a_daemons_map(folder);
    return finish_interrupted(folder);
}

}  // namespace octoskin
