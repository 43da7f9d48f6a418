#include "host/apps/recording/text_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
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

Status<AppError> write_text(const std::filesystem::path& file, std::string_view text) {
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    int error = descriptor < 0 ? errno : write_all(descriptor, text);
    if (descriptor >= 0 && ::close(descriptor) != 0 && error == 0) error = errno;
    if (error == 0) return Done{};
    return fail(ExitCode::cannot_create, fmt::format("{}: cannot be written ({}): {}", file.string(),
                                                     std::generic_category().message(error),
                                                     remedy_of({error, std::generic_category()})));
}

}  // namespace octoskin
