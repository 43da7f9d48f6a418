#include "host/io/robot/fit_store.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "host/io/digest/sha256.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/folder/replacing_file.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOctoskin = "octoskin";
constexpr const char* kRobots = "robots";
constexpr std::size_t kDigestLength = 64;
constexpr std::size_t kBytesMax = std::size_t{16} << 20U;  // size limit of a URDF
constexpr mode_t kOthersWrite = S_IWGRP | S_IWOTH;
constexpr mode_t kOurs = 0700;
constexpr mode_t kOurFile = 0600;

fs::path folder_in(const char* variable) {
    const char* const text = std::getenv(variable);
    fs::path folder = text == nullptr ? "" : text;
    return folder.is_absolute() ? folder : fs::path();
}

std::string name_of(const std::string& key) {
    return key + ".fit";
}

Unexpected<Error> refused(const FolderError& error) {
    return unexpected(to_error(error));
}

Unexpected<Error> refused(int error_number, const fs::path& path) {
    return refused(folder_error_of(error_number, path));
}

Unexpected<Error> not_private(const fs::path& path) {
    return unexpected(Error{.code = ErrorCode::foreign_owner,
                            .what = "belongs to another user, or others may write it",
                            .remedy = "remove it, or set XDG_CACHE_HOME to a folder of your own",
                            .file = path});
}

/// Whether only this user may change what the descriptor refers to.
Status<Error> check_private(int descriptor, const fs::path& path, bool has_one_name) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) return refused(errno, path);
    const bool is_ours = status.st_uid == ::geteuid() && (status.st_mode & kOthersWrite) == 0;
    if (!is_ours || (has_one_name && status.st_nlink != 1)) return not_private(path);
    return Done{};
}

/// The digest of a kept file: of its key, too, so that it is of no use under another one.
std::string digest_of(const std::string& key, std::string_view urdf) {
    Sha256 digest;
    digest.add_field(key);
    digest.add_field(urdf);
    return digest.hexadecimal();
}

/// The URDF in a kept file: the first line is the digest.
std::optional<std::string> urdf_in(const std::string& key, std::string bytes) {
    if (bytes.size() <= kDigestLength || bytes[kDigestLength] != '\n') return std::nullopt;
    const std::string digest = bytes.substr(0, kDigestLength);
    bytes.erase(0, kDigestLength + 1);
    if (digest_of(key, bytes) != digest) return std::nullopt;
    return bytes;
}

Status<Error> write_all(int descriptor, std::string_view bytes, const fs::path& path) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return refused(errno, path);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return Done{};
}

}  // namespace

FitStore FitStore::of_this_user() {
    if (const fs::path cache = folder_in("XDG_CACHE_HOME"); !cache.empty()) return FitStore(cache);
    if (const fs::path home = folder_in("HOME"); !home.empty()) return FitStore(home / ".cache");
    return FitStore(fs::path());
}

FitStore::FitStore(fs::path cache) : cache_(std::move(cache)) {}

fs::path FitStore::folder() const {
    return cache_.empty() ? fs::path() : cache_ / kOctoskin / kRobots;
}

Result<std::optional<std::string>, Error> FitStore::find(const std::string& key) const {
    const std::optional<std::string> none;
    if (cache_.empty()) return none;
    auto folder = OpenFolder::open(cache_, FolderAccess::read);
    fs::path shown = cache_;
    for (const char* const name : {kOctoskin, kRobots}) {
        if (folder) folder = folder->open_folder(name);
        if (!folder && folder.error().fault == FolderFault::absent) return none;
        if (!folder) return refused(folder.error());
        shown /= name;
        if (const auto checked = check_private(folder->descriptor(), shown, false); !checked)
            return unexpected(checked.error());
    }
    const auto file = folder->open_file(name_of(key));
    if (!file && file.error().fault == FolderFault::absent) return none;
    if (!file) return refused(file.error());
    if (const auto checked = check_private(file->descriptor(), file->shown(), true); !checked)
        return unexpected(checked.error());
    auto bytes = file->read(kBytesMax);
    if (!bytes) return refused(bytes.error());
    auto urdf = urdf_in(key, *std::move(bytes));
    if (urdf) return urdf;
    return unexpected(Error{.code = ErrorCode::damaged,
                            .what = "is cut or damaged",
                            .remedy = "remove it",
                            .file = file->shown()});
}

/// Opens the folder for writing; a new one is for this user alone.
Result<OpenFolder, Error> FitStore::make_folder() const {
    auto made = make_open_folder(cache_);
    if (!made) return refused(made.error());
    if (made->is_new && ::fchmod(made->folder.descriptor(), kOurs) != 0) return refused(errno, cache_);
    OpenFolder folder = made->folder;
    fs::path shown = cache_;
    for (const char* const name : {kOctoskin, kRobots}) {
        shown /= name;
        auto below = FilePlace(folder, name).make_folder();
        if (!below) return refused(below.error());
        if (below->is_new && ::fchmod(below->folder.descriptor(), kOurs) != 0) return refused(errno, shown);
        if (const auto checked = check_private(below->folder.descriptor(), shown, false); !checked)
            return unexpected(checked.error());
        folder = below->folder;
    }
    return folder;
}

Status<Error> FitStore::keep(const std::string& key, const std::string& urdf) const {
    if (cache_.empty())
        return unexpected(Error{.code = ErrorCode::not_found,
                                .what = "neither XDG_CACHE_HOME nor HOME names a folder",
                                .remedy = "set one of them"});
    const auto folder = make_folder();
    if (!folder) return unexpected(folder.error());
    auto file = ReplacingFile::begin(FilePlace(*folder, name_of(key)));
    if (!file) return refused(file.error());
    const fs::path shown = this->folder() / name_of(key);
    if (::fchmod(file->descriptor(), kOurFile) != 0) return refused(errno, shown);
    if (auto written = write_all(file->descriptor(), digest_of(key, urdf) + '\n' + urdf, shown); !written)
        return written;
    if (const auto done = file->commit(); !done) return refused(done.error());
    return Done{};
}

}  // namespace octoskin
