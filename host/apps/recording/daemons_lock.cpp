#include "host/apps/recording/daemons_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <string>
#include <utility>

namespace octoskin {
namespace {

constexpr unsigned kMode = 0600;  // others could lock a file that they can open

/// In a folder of another user, a lock file of root's would keep that user's octoskin out for ever.
void give_to_owner(const OpenFile& file, const OpenFolder& folder) {
    struct stat status {};
    if (::geteuid() != 0 || ::fstat(folder.descriptor(), &status) != 0) return;
    (void)!::fchown(file.descriptor(), status.st_uid, status.st_gid);
}

}  // namespace

Result<DaemonsLockFile, FolderError> open_daemons_lock(const OpenFolder& folder) {
    auto opened = folder.open_file(kDaemonsLock);
    if (opened) return DaemonsLockFile{std::move(*opened)};
    if (opened.error().fault != FolderFault::absent) return unexpected(opened.error());
    auto created = folder.create_new(kDaemonsLock, kMode);
    if (created) {
        give_to_owner(*created, folder);
        return DaemonsLockFile{.file = std::move(*created), .is_new = true};
    }
    if (created.error().fault != FolderFault::is_there) return unexpected(created.error());
    opened = folder.open_file(kDaemonsLock);  // another process was faster
    if (!opened) return unexpected(opened.error());
    return DaemonsLockFile{std::move(*opened)};
}

void write_holder(const OpenFile& file) {
    const std::string own = std::to_string(::getpid());
    const Descriptor to_write(::open(file.path_for_libraries().c_str(), O_WRONLY | O_CLOEXEC));
    if (!to_write) return;
    // On a full disk the id is missing: only the lock matters.
    (void)!::ftruncate(to_write.get(), 0);
    (void)!::pwrite(to_write.get(), own.data(), own.size(), 0);
}

std::string holder_of(const OpenFile& file) {
    std::array<char, 32> text{};
    const ssize_t count = ::pread(file.descriptor(), text.data(), text.size(), 0);
    int process = 0;
    if (count <= 0 || std::from_chars(text.data(), text.data() + count, process).ec != std::errc{}) return {};
    // An earlier daemon's, in a file that another process holds for the moves of its files.
    if (process <= 0 || (::kill(process, 0) != 0 && errno == ESRCH)) return {};
    return " (process " + std::to_string(process) + ")";
}

Result<std::optional<DaemonsKeptOut>, FolderError> DaemonsKeptOut::from(const OpenFolder& folder) {
    auto opened = open_daemons_lock(folder);
    if (!opened && folder.kind_of(kDaemonsLock) == EntryKind::absent) return unexpected(opened.error());
    if (!opened) return std::optional(DaemonsKeptOut(FileLock::of_nothing(), std::nullopt));
    if (opened->is_new) write_holder(opened->file);
    auto lock = FileLock::take(std::move(opened->file), FilePlace(folder, kDaemonsLock));
    if (!lock) return std::optional<DaemonsKeptOut>();
    return std::optional(
        DaemonsKeptOut(std::move(*lock), opened->is_new ? std::optional(folder) : std::nullopt));
}

DaemonsKeptOut::DaemonsKeptOut(DaemonsKeptOut&& other) noexcept
    : lock_(std::move(other.lock_)), made_in_(std::exchange(other.made_in_, std::nullopt)) {}

DaemonsKeptOut::~DaemonsKeptOut() {
    // A daemon that has it open finds that it has no name any more, and creates another one.
    if (made_in_) static_cast<void>(made_in_->remove(kDaemonsLock));
}

}  // namespace octoskin
