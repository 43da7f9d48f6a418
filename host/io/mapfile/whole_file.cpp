#include "host/io/mapfile/whole_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace octoskin {
namespace {

Unexpected<Error> fail(const FilePlace& file, Error error) {
    return unexpected(in_file(std::move(error), file.shown()));
}

}  // namespace

Result<std::string, Error> read_whole_file(const FilePlace& file, std::uint64_t bytes_max) {
    const auto opened = file.open();
    if (!opened) {
        const FolderError& error = opened.error();
        if (error.fault == FolderFault::not_a_file)
            return fail(file, {ErrorCode::wrong_kind_of_file, "not a regular file"});
        if (error.fault == FolderFault::link) return unexpected(to_error(error));
        return fail(file, {code_of(error.fault), fmt::format("opening failed ({})", error.reason())});
    }
    struct stat status {};
    if (::fstat(opened->descriptor(), &status) != 0)
        return fail(file, {ErrorCode::system_error,
                           fmt::format("examining it failed ({})", std::generic_category().message(errno))});
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size > bytes_max) {
        return fail(file, {ErrorCode::too_large, fmt::format("expected at most {} bytes", bytes_max),
                           std::to_string(size)});
    }
    auto bytes = opened->read(size);
    if (!bytes)
        return fail(file,
                    {ErrorCode::system_error, fmt::format("reading failed ({})", bytes.error().reason())});
    if (bytes->size() < size) return fail(file, {ErrorCode::damaged, "became shorter while it was read"});
    bytes->resize(size);  // bytes added since belong to another save
    return std::move(*bytes);
}

}  // namespace octoskin
