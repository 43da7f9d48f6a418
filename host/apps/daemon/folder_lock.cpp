#include "host/apps/daemon/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "host/apps/recording/text_file.hpp"

namespace octoskin {
namespace {

constexpr const char* kLockFile = "lock";

/// Who holds it wrote its process id there; empty if it could not.
std::string holder_of(int descriptor) {
    std::array<char, 32> text{};
    const ssize_t count = ::pread(descriptor, text.data(), text.size(), 0);
    return count > 0 ? " (process " + std::string(text.data(), static_cast<std::size_t>(count)) + ")"
                     : std::string();
}

}  // namespace

Result<FolderLock, AppError> FolderLock::take(const std::filesystem::path& folder) {
    std::error_code made;
    std::filesystem::create_directories(folder, made);
    const std::string file = (folder / kLockFile).string();
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0640);
    if (descriptor < 0) {
        const std::error_code why = made ? made : std::error_code(errno, std::generic_category());
        return cannot_create(folder, "no maps can be saved there (" + why.message() + "): " + remedy_of(why) +
                                         "; --maps names the folder");
    }
    FolderLock lock(descriptor);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
        return cannot_create(folder, "another octoskin" + holder_of(descriptor) +
                                         " keeps its map there; stop it, or name another folder");
    }
    const std::string own = std::to_string(::getpid());
    // On a full disk it goes without: who holds the lock counts, not what is in it.
    (void)!::ftruncate(descriptor, 0);
    (void)!::pwrite(descriptor, own.data(), own.size(), 0);
    return lock;
}

FolderLock::FolderLock(FolderLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

FolderLock::~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace octoskin
