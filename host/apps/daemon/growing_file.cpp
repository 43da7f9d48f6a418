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

Unexpected<std::string> GrowingFile::failure() const {
    return unexpected(file_.string() + ": " + std::generic_category().message(errno));
}

Status<std::string> GrowingFile::create(const FilePlace& file) {
    constexpr unsigned kReadableByAll = 0644;
    file_ = file.shown();
    auto created = file.create_new(kReadableByAll);
    if (!created) return unexpected(created.error().message());
    descriptor_ = created->release();
    return Done{};
}

Status<std::string> GrowingFile::append(const std::string& text) {
    std::string_view rest = text;
    while (!rest.empty()) {  // each round writes a part
        const ssize_t count = ::write(descriptor_, rest.data(), rest.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return failure();
        rest.remove_prefix(static_cast<std::size_t>(count));
    }
    return Done{};
}

Status<std::string> GrowingFile::check() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) return failure();
    if (status.st_nlink == 0) return unexpected(file_.string() + ": was removed while it was written");
    return Done{};
}

Status<std::string> GrowingFile::finish() {
    const bool is_synced = ::fsync(descriptor_) == 0;
    if (!is_synced) return failure();
    const bool is_closed = ::close(descriptor_) == 0;
    descriptor_ = -1;
    if (!is_closed) return failure();
    return Done{};
}

}  // namespace octoskin
