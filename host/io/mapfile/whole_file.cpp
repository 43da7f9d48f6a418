#include "host/io/mapfile/whole_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace octoskin {
namespace {

Unexpected<WholeFileError> fail(const FilePlace& file, const std::string& what, bool is_too_large = false) {
    return unexpected(WholeFileError{fmt::format("{}: {}", file.shown().string(), what), is_too_large});
}

}  // namespace

Result<std::string, WholeFileError> read_whole_file(const FilePlace& file, std::uint64_t bytes_max) {
    const auto opened = file.open();
    if (!opened) {
        const FolderError& error = opened.error();
        if (error.fault == FolderFault::not_a_file) return fail(file, "not a regular file");
        if (error.fault == FolderFault::link) return unexpected(WholeFileError{error.message(), false});
        return fail(file, fmt::format("opening failed ({})", error.reason()));
    }
    struct stat status {};
    if (::fstat(opened->descriptor(), &status) != 0)
        return fail(file, fmt::format("examining it failed ({})", std::generic_category().message(errno)));
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size > bytes_max) return fail(file, fmt::format("{} bytes, the limit is {}", size, bytes_max), true);
    auto bytes = opened->read(size);
    if (!bytes) return fail(file, fmt::format("reading failed ({})", bytes.error().reason()));
    if (bytes->size() < size) return fail(file, "became shorter while it was read");
    bytes->resize(size);  // bytes added since belong to another save
    return std::move(*bytes);
}

}  // namespace octoskin
