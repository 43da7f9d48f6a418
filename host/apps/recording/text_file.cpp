#include "host/apps/recording/text_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace octoskin {
namespace {

/// 0, or why not.
int write_all(int descriptor, std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = ::write(descriptor, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return written == 0 ? EIO : errno;
        text.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
}

/// What a path that was typed leads to, emptied; or 0 for success, else why not. EMLINK: a file with several
/// names, which is left as it is.
int open_typed(const std::filesystem::path& file, Descriptor& opened) {
    opened = Descriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (opened) return 0;
    // Not EEXIST alone: O_EXCL does not follow a link to something that is yet to be made.
    opened = Descriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
    if (!opened) return errno;
    struct stat status {};
    if (::fstat(opened.get(), &status) != 0) return errno;
    if (!S_ISREG(status.st_mode)) return 0;
    if (status.st_nlink > 1) return EMLINK;
    return ::ftruncate(opened.get(), 0) == 0 ? 0 : errno;
}

FilePlace behind_links(const std::filesystem::path& typed) {
    std::error_code error;
    auto behind = std::filesystem::canonical(typed, error);
    return error ? typed : behind;
}

/// What no other place on the disk would help against.
bool is_of_folder(FolderFault fault) {
    return fault == FolderFault::link || fault == FolderFault::foreign_owner ||
           fault == FolderFault::outside || fault == FolderFault::is_there;
}

}  // namespace

std::string remedy_of(const std::error_code& error) {
    switch (error.value()) {
        case ENOSPC:
        case EDQUOT:
        case EFBIG:
            return "make room there, or write elsewhere";
        case EACCES:
        case EPERM:
            return "it is not yours to write: another folder, or its owner";
        case EROFS:
            return "the file system is read-only: write elsewhere";
        case ENOENT:
        case ENOTDIR:
            return "its folder is not there: make it, or write elsewhere";
        case EISDIR:
            return "it is a folder: name a file, or move the folder away";
        default:
            return "is the disk well, and the file system there?";
    }
}

Status<AppError> write_text(const FilePlace& file, std::string_view text) {
    Descriptor opened;
    int error = 0;
    if (file.folder() == nullptr) error = open_typed(file.name(), opened);
    if (file.folder() != nullptr || error == EMLINK) {
        auto created =
            file.folder() != nullptr ? file.create_anew() : behind_links(file.name()).create_anew();
        error = created ? 0 : created.error().error_number;
        if (!created && is_of_folder(created.error().fault))
            return cannot_create(created.error().path, created.error().reason());
        if (created) opened = Descriptor(created->release());
    }
    if (error == 0) error = write_all(opened.get(), text);
    if (opened && ::close(opened.release()) != 0 && error == 0) error = errno;
    if (error == 0) return Done{};
    return fail(ExitCode::cannot_create, fmt::format("{}: cannot be written ({}): {}", file.shown().string(),
                                                     std::generic_category().message(error),
                                                     remedy_of({error, std::generic_category()})));
}

Status<AppError> copy_file(const FilePlace& from, const FilePlace& to) {
    constexpr std::size_t kBytesMax = std::size_t{64} << 20U;  // four times the largest robot that is read
    const auto opened = from.open();
    if (!opened) return cannot_create(to.shown(), opened.error().message());
    const auto bytes = opened->read(kBytesMax);
    if (!bytes) return cannot_create(to.shown(), bytes.error().message());
    if (bytes->size() > kBytesMax) return cannot_create(to.shown(), from.shown().string() + " is too large");
    return write_text(to, *bytes);
}

}  // namespace octoskin
