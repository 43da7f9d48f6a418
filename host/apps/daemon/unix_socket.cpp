#include "host/apps/daemon/unix_socket.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "host/apps/recording/file_lock.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/folder/open_folder.hpp"
#include "host/io/socketcan/passed_descriptors.hpp"

namespace octoskin {
namespace {

constexpr int kWaiting = 16;

std::optional<sockaddr_un> address_of(const std::filesystem::path& file) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string name = file.string();
    if (name.empty() || name.size() >= sizeof(address.sun_path)) return std::nullopt;
    std::memcpy(address.sun_path, name.data(), name.size());
    return address;
}

Unexpected<AppError> failure(const std::filesystem::path& file, const std::string& what, int error) {
    const std::string reason = what + ": " + std::strerror(error);
    if (error == EACCES || error == EPERM)
        return fail(ExitCode::no_permission, in_file({ErrorCode::no_permission, reason}, file));
    if (error == ENOENT) return fail(ExitCode::unavailable, in_file({ErrorCode::not_found, reason}, file));
    return cannot_create(file, {ErrorCode::system_error, reason});
}

Unexpected<AppError> wrong_length(const std::filesystem::path& file) {
    return fail(ExitCode::usage, {.code = ErrorCode::bad_name,
                                  .what = "expected a socket's path of 1 to 107 bytes",
                                  .value = std::to_string(file.string().size()) + " bytes",
                                  .file = file});
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
    return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

/// Adds the remedy for a place where no socket can be created.
Unexpected<AppError> cannot_listen(const std::filesystem::path& file, const std::string& option, int error) {
    const std::string folder = folder_of(file).string();
    const std::string elsewhere = "name a place elsewhere with " + option;
    if (error == ENOENT) {
        return fail(ExitCode::unavailable,
                    {.code = ErrorCode::not_found,
                     .what = "cannot listen there: the folder " + folder + " does not exist",
                     .remedy = "create it, or " + elsewhere,
                     .file = file});
    }
    if (error == ENOTDIR) {
        return fail(ExitCode::unavailable, {.code = ErrorCode::wrong_kind_of_file,
                                            .what = "cannot listen there: " + folder + " is no folder",
                                            .remedy = elsewhere,
                                            .file = file});
    }
    auto failed = failure(file, "cannot listen there", error);
    failed.error.error.remedy = elsewhere;
    return failed;
}

/// The process that listens where `probe` is connected, as " (process 123)"; empty if the kernel does not
/// know it: it has none for datagrams, and no number for one of another container.
std::string listener_of(int probe) {
    ucred listener{};
    socklen_t size = sizeof(listener);
    const bool is_known = ::getsockopt(probe, SOL_SOCKET, SO_PEERCRED, &listener, &size) == 0;
    return is_known && listener.pid > 0 ? " (process " + std::to_string(listener.pid) + ")" : std::string();
}

/// Empty if there is no listener, else a description of it. Does not wait for one that accepts no connection.
std::optional<std::string> find_listener(const sockaddr_un& address, int type) {
    const int probe = ::socket(AF_UNIX, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (probe < 0) return std::nullopt;
    const bool is_connected =
        ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    // Refused, or no such name: no listener. On any other error there may be one.
    const bool is_unknown =
        !is_connected && (errno == ECONNREFUSED || errno == ENOENT || errno == ENOTDIR || errno == ENOTSOCK);
    const bool is_full = !is_connected && errno == EAGAIN;
    const std::string listener = is_connected ? listener_of(probe)
                                 : is_full    ? " (it accepts no connection: is it stopped?)"
                                              : std::string();
    ::close(probe);
    return is_unknown ? std::nullopt : std::optional(listener);
}

/// Held from the check for another daemon until the socket is bound: two daemons that start at once would
/// each find none, and the later one would take the earlier one's name. Locks a file that no other user can
/// open, because others can lock a file that they can open.
class StartLock {
  public:
    /// Not taken if another process holds it for two seconds. If the file cannot be created, it locks
    /// nothing: the next step there reports the error.
    explicit StartLock(const std::filesystem::path& socket) : name_(socket.filename().string() + ".lock") {
        constexpr int kTries = 400;
        constexpr std::chrono::milliseconds kPause{5};
        if (auto folder = OpenFolder::open(folder_of(socket), FolderAccess::write))
            folder_ = std::move(*folder);
        lock_ = take();
        for (int i = 0; i < kTries && !lock_; ++i) {
            std::this_thread::sleep_for(kPause);
            lock_ = take();
        }
    }
    ~StartLock() {
        if (is_own_ && lock_) (void)folder_->remove(name_);  // while it is locked
    }
    StartLock(const StartLock&) = delete;
    StartLock& operator=(const StartLock&) = delete;

    [[nodiscard]] bool is_taken() const noexcept { return lock_.has_value(); }

  private:
    std::optional<FileLock> take() {
        constexpr unsigned kOwnersMode = 0600;
        is_own_ = false;
        if (!folder_) return FileLock::of_nothing();
        const auto created = folder_->create_new(name_, kOwnersMode);
        if (!created && created.error().fault != FolderFault::is_there) return FileLock::of_nothing();
        auto file = folder_->open_file(name_);
        if (!file && file.error().fault == FolderFault::absent) return std::nullopt;  // removed just now
        struct stat status {};
        is_own_ = file && ::fstat(file->descriptor(), &status) == 0 && status.st_uid == ::geteuid() &&
                  (status.st_mode & 0077U) == 0;
        return is_own_ ? FileLock::take(std::move(*file), {*folder_, name_}) : FileLock::of_nothing();
    }

    std::string name_;
    std::optional<OpenFolder> folder_;
    bool is_own_ = false;
    std::optional<FileLock> lock_;
};

}  // namespace

SocketFile::SocketFile(std::filesystem::path path) : path_(std::move(path)), bound_(found()) {}

void SocketFile::remove() const {
    if (bound_ && found() == bound_) ::unlink(path_.c_str());
}

std::optional<SocketFile::Identity> SocketFile::found() const {
    struct stat status {};
    if (::lstat(path_.c_str(), &status) != 0) return std::nullopt;
    return Identity{status.st_dev, status.st_ino};
}

Result<BoundSocket, AppError> bind_unix_socket(const std::filesystem::path& file, int type,
                                               const std::string& option) {
    const auto address = address_of(file);
    if (!address) return wrong_length(file);
    const StartLock lock(file);
    if (!lock.is_taken()) {
        return cannot_create(
            file, {.code = ErrorCode::in_use,
                   .what = "another octoskin keeps " + file.filename().string() + ".lock beside it locked",
                   .remedy = "end that octoskin, or let it continue if it is stopped while starting"});
    }
    if (const auto listener = find_listener(*address, type)) {
        return cannot_create(file, {.code = ErrorCode::in_use,
                                    .what = "another octoskin" + *listener + " has this socket",
                                    .remedy = "stop it, or name another socket with " + option});
    }
    struct stat found {};
    if (::lstat(file.c_str(), &found) == 0) {
        if (!S_ISSOCK(found.st_mode))
            return cannot_create(file, {.code = ErrorCode::wrong_kind_of_file,
                                        .what = "is there and is no socket",
                                        .remedy = "move it away, or name another socket with " + option});
        ::unlink(file.c_str());
    }
    const int descriptor = ::socket(AF_UNIX, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (descriptor < 0) return failure(file, "no socket", errno);
    socketcan::refuse_descriptors(descriptor);  // before any can be sent to it
    const auto* generic = reinterpret_cast<const sockaddr*>(&*address);
    const mode_t others = ::umask(0007);
    const bool is_bound = ::bind(descriptor, generic, sizeof(*address)) == 0;
    const int error = errno;
    ::umask(others);
    if (!is_bound || (type == SOCK_STREAM && ::listen(descriptor, kWaiting) != 0)) {
        const int why = is_bound ? errno : error;
        ::close(descriptor);
        return cannot_listen(file, option, why);
    }
    return BoundSocket{descriptor, SocketFile(file)};  // while the lock keeps other daemons from the name
}

Result<int, AppError> connect_unix_socket(const std::filesystem::path& file, int type,
                                          std::chrono::milliseconds patience) {
    const auto address = address_of(file);
    if (!address) return wrong_length(file);
    const int descriptor = ::socket(AF_UNIX, type | SOCK_CLOEXEC, 0);
    if (descriptor < 0) return failure(file, "no socket", errno);
    // connect(2) waits for room among the connections not accepted yet, as long as a send may.
    const timeval limit{.tv_sec = patience.count() / 1000, .tv_usec = patience.count() % 1000 * 1000};
    ::setsockopt(descriptor, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof(limit));
    if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&*address), sizeof(*address)) == 0)
        return descriptor;
    const int error = errno;
    ::close(descriptor);
    if (error == ECONNREFUSED || error == ENOENT) {
        return fail(ExitCode::unavailable,
                    {.code = ErrorCode::no_listener,
                     .what = "no octoskin listens there",
                     .remedy = "start `octoskin run`, or name another place with --socket",
                     .file = file});
    }
    if (error == EAGAIN) {
        return fail(ExitCode::io_failed, {.code = ErrorCode::no_answer,
                                          .what = "the daemon accepts no connection",
                                          .remedy = "let it continue if it is stopped, or restart it",
                                          .file = file});
    }
    return failure(file, "cannot connect", error);
}

}  // namespace octoskin
