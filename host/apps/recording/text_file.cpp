#include "host/apps/recording/text_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

#include "host/io/folder/replacing_file.hpp"

namespace octoskin {
namespace {

/// Returns 0, or the error number.
int write_all(int descriptor, std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = ::write(descriptor, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return written == 0 ? EIO : errno;
        text.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
}

/// The number of a descriptor of this process that the path names, such as /dev/stdout; -1: none.
int descriptor_of(const std::filesystem::path& typed) {
    std::error_code error;
    const auto own = std::filesystem::canonical("/proc/self/fd", error);
    const auto folder = std::filesystem::canonical(typed.parent_path(), error);
    auto named = typed;
    if (folder == "/dev" && std::filesystem::is_symlink(typed, error)) {  // stdout, stderr
        named = std::filesystem::read_symlink(typed, error);
        if (std::filesystem::canonical(named.parent_path(), error) != own) return -1;
    } else if (own.empty() || folder != own) {
        return -1;
    }
    int number = -1;
    const std::string digits = named.filename().string();
    const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    return parsed.ec == std::errc{} && parsed.ptr == digits.data() + digits.size() ? number : -1;
}

/// A device, a pipe or a descriptor named directly is written to, not replaced; a link to one is replaced.
bool takes_what_is_written(const FilePlace& file) {
    if (file.folder() != nullptr) return false;
    if (descriptor_of(file.name()) >= 0) return true;
    struct stat status {};
    if (::lstat(file.name().c_str(), &status) != 0) return false;
    return !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode) && !S_ISLNK(status.st_mode);
}

Descriptor open_as_it_is(const std::filesystem::path& typed) {
    const int number = descriptor_of(typed);
    if (number < 0) return Descriptor(::open(typed.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW));
    static_cast<void>(std::fflush(stdout));  // keeps the order with earlier printed output
    return Descriptor(::fcntl(number, F_DUPFD_CLOEXEC, 0));
}

Unexpected<AppError> cannot_write(const FilePlace& file, int error,
                                  ErrorCode code = ErrorCode::system_error) {
    return cannot_create(
        file.shown(), {.code = code,
                       .what = fmt::format("cannot be written ({})", std::generic_category().message(error)),
                       .remedy = remedy_of({error, std::generic_category()})});
}

Unexpected<AppError> cannot_write(const FilePlace& file, const FolderError& error) {
    // Faults that another place on the disk would not avoid.
    const bool is_of_folder = error.fault == FolderFault::link || error.fault == FolderFault::foreign_owner ||
                              error.fault == FolderFault::outside;
    const bool is_typed_itself = file.folder() == nullptr && error.path == file.shown();
    if (is_of_folder || (error.fault == FolderFault::is_there && !is_typed_itself))
        return fail(ExitCode::cannot_create, to_error(error));
    const bool is_in_the_way = error.fault == FolderFault::is_there;  // and is not a regular file
    return cannot_write(file, error.error_number,
                        is_in_the_way ? ErrorCode::wrong_kind_of_file : code_of(error.fault));
}

bool is_same(const std::filesystem::path& one, const std::filesystem::path& other) {
    std::error_code ignored;  // of a file that is not there yet
    return one.lexically_normal() == other.lexically_normal() ||
           std::filesystem::equivalent(one, other, ignored);
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
            return "you may not write it: choose another folder, or ask its owner";
        case EROFS:
            return "the file system is read-only: write elsewhere";
        case ENOENT:
        case ENOTDIR:
            return "its folder does not exist: make it, or write elsewhere";
        case EEXIST:
            return "it is not a regular file: name another one, or move it away";
        case EISDIR:
            return "it is a folder: name a file, or move the folder away";
        default:
            return "check the disk and whether the file system is mounted";
    }
}

Status<AppError> write_text(const FilePlace& file, std::string_view text) {
    if (takes_what_is_written(file)) {
        Descriptor opened = open_as_it_is(file.name());
        int error = opened ? write_all(opened.get(), text) : errno;
        if (opened && ::close(opened.release()) != 0 && error == 0) error = errno;
        if (error != 0) return cannot_write(file, error);
        return Done{};
    }
    auto replacing = ReplacingFile::begin(file);
    if (!replacing) return cannot_write(file, replacing.error());
    if (const int error = write_all(replacing->descriptor(), text); error != 0)
        return cannot_write(file, error);
    if (const auto committed = replacing->commit(); !committed) return cannot_write(file, committed.error());
    return Done{};
}

Status<AppError> check_text_place(const FilePlace& file) {
    if (takes_what_is_written(file)) return Done{};
    if (const auto checked = ReplacingFile::check(file); !checked) return cannot_write(file, checked.error());
    return Done{};
}

Status<AppError> check_replaces_none(const std::filesystem::path& output,
                                     std::span<const std::filesystem::path> files) {
    if (output.empty()) return Done{};
    const auto taken = std::ranges::find_if(files, [&](const auto& file) { return is_same(output, file); });
    if (taken == files.end()) return Done{};
    return fail(ExitCode::usage, {.code = ErrorCode::conflict,
                                  .what = "an output would replace this file",
                                  .remedy = "give another name",
                                  .file = *taken});
}

Status<AppError> copy_file(const FilePlace& from, const FilePlace& to) {
    constexpr std::size_t kBytesMax = std::size_t{64} << 20U;  // four times the size limit of a robot file
    const std::string before = fmt::format("cannot be copied to {}: ", to.shown().string());
    const auto bytes = from.read(kBytesMax);
    if (!bytes) return fail(ExitCode::cannot_create, to_error(bytes.error(), before));
    if (bytes->size() > kBytesMax) {
        return fail(ExitCode::cannot_create,
                    {.code = ErrorCode::too_large,
                     .what = fmt::format("{}expected at most {} MiB", before, kBytesMax >> 20U),
                     .value = "more",
                     .file = from.shown()});
    }
    return write_text(to, *bytes);
}

}  // namespace octoskin
