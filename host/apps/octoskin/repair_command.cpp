// octoskin repair: completes the file moves of a killed octoskin, and removes the drafts that it had not
// moved.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/daemon/folder_lock.hpp"
#include "host/apps/daemon/map_saver.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/recording/file_lock.hpp"
#include "host/apps/recording/file_set.hpp"
#include "host/io/folder/open_folder.hpp"
#include "host/io/mapfile/atomic_file.hpp"

namespace octoskin::app {
namespace {

/// In a recording its maps; in an experiment its recording.
constexpr const char* kFoldersWithin[] = {"maps", "recording", "recording/maps"};

AppError error_of(const FolderError& error) {
    ExitCode exit = ExitCode::cannot_create;
    if (error.fault == FolderFault::absent || error.fault == FolderFault::not_a_folder)
        exit = ExitCode::no_input;
    if (error.fault == FolderFault::not_permitted) exit = ExitCode::no_permission;
    return {exit, to_error(error)};
}

bool is_finished(const OpenFolder& folder) {
    if (!value_or_fail(settle_file_set(folder))) return false;
    print("{}: the files that were left half moved are in their places\n", folder.shown().string());
    return true;
}

/// Completes a save of the daemon, and removes drafts of killed processes. Drafts of a running process are
/// left alone: it holds the lock, a daemon the one of the folder of maps. `stayed`: counts those that cannot
/// be removed; each is named.
bool is_cleared(const OpenFolder& folder, std::size_t& stayed) {
    const auto lock = FileLock::take(folder, FileLock::Kind::exclusive);
    const auto lock_of_maps = FileLock::take(FilePlace(folder, FolderLock::kFile), FileLock::Kind::exclusive);
    if (!lock || !lock_of_maps) return false;
    const auto complain = [&stayed](const FolderError& error) {
        spdlog::error("{}", error.message());
        ++stayed;
    };
    const bool is_save_finished = finish_save(folder);
    if (is_save_finished)
        print("{}: fused.snapshot, which belongs to fused.ot, is in its place\n", folder.shown().string());
    std::size_t drafts = remove_leftovers(folder, complain);
    if (folder.kind_of(FileSet::kDraftFolder) == EntryKind::folder) {
        const auto gone = folder.remove_all(FileSet::kDraftFolder);
        if (gone) ++drafts;
        if (!gone) complain(gone.error());
    }
    if (drafts > 0) print("{}: drafts of killed runs are removed: {}\n", folder.shown().string(), drafts);
    return drafts > 0 || is_save_finished;
}

bool is_repaired(const OpenFolder& folder, std::size_t& stayed) {
    const bool is_any = is_finished(folder);
    return is_cleared(folder, stayed) || is_any;
}

void repair(const std::filesystem::path& named) {
    const auto folder = OpenFolder::open(named, FolderAccess::write);
    if (!folder) throw CommandFailure(error_of(folder.error()));
    std::size_t stayed = 0;
    bool is_any = is_repaired(*folder, stayed);
    for (const char* const name : kFoldersWithin) {
        if (folder->kind_of(name) != EntryKind::folder) continue;
        const auto within = folder->open_folder(name);
        if (!within) throw CommandFailure(error_of(within.error()));
        is_any = is_repaired(*within, stayed) || is_any;
    }
    if (stayed > 0) {
        throw CommandFailure(
            ExitCode::cannot_create,
            {.code = ErrorCode::system_error,
             .what =
                 fmt::format("{} drafts of killed runs cannot be removed; the lines above name them", stayed),
             .remedy = "remove them yourself",
             .file = named});
    }
    if (!is_any) print("{}: nothing is half moved there\n", named.string());
}

}  // namespace

void add_repair_command(CLI::App& app) {
    auto folder = std::make_shared<std::filesystem::path>();
    CLI::App* command = app.add_subcommand(
        "repair",
        "Complete the file moves of a killed octoskin in a recording, a maps folder or an experiment");
    command->add_option("folder", *folder, "The folder, owned by you or root")->required();
    command->callback([folder] { repair(*folder); });
}

}  // namespace octoskin::app
