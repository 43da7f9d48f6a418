#include "host/apps/daemon/growing_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>
#include <system_error>

namespace octoskin {

GrowingFile::~GrowingFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

Unexpected<Error> GrowingFile::failure() const {
    return unexpected(in_file({ErrorCode::system_error, std::generic_category().message(errno)}, file_));
}

Status<Error> GrowingFile::create(const FilePlace& file) {
    constexpr unsigned kReadableByAll = 0644;
    file_ = file.shown();
    auto created = file.create_new(kReadableByAll);
    if (!created) return unexpected(to_error(created.error()));
    descriptor_ = created->release();
    return Done{};
}

Status<Error> GrowingFile::append(const std::string& text) {
    std::string_view rest = text;
    while (!rest.empty()) {  // each round writes a part
        const ssize_t count = ::write(descriptor_, rest.data(), rest.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return failure();
        rest.remove_prefix(static_cast<std::size_t>(count));
    }
    return Done{};
}

Status<Error> GrowingFile::check() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) return failure();
    if (status.st_nlink == 0)
        return unexpected(in_file({ErrorCode::not_found, "was removed while it was written"}, file_));
    return Done{};
}

Status<Error> GrowingFile::finish() {
    const bool is_synced = ::fsync(descriptor_) == 0;
    if (!is_synced) return failure();
    const bool is_closed = ::close(descriptor_) == 0;
    descriptor_ = -1;
    if (!is_closed) return failure();
    return Done{};
}

}  // namespace octoskin
