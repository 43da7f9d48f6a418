#include "host/bridge/mcap/output_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "host/apps/recording/text_file.hpp"

namespace octoskin::bridge {
namespace {

std::string draft_of(const std::string& name) {
    return "." + name + ".octoskin-part";
}

Unexpected<AppError> refused(const FilePlace& file, const FolderError& error) {
    return cannot_create(file.shown(), to_error(error));
}

}  // namespace

Result<OutputFile, AppError> OutputFile::begin(const FilePlace& file, bool may_replace) {
    const EntryKind there = file.kind();
    const bool is_free = there == EntryKind::absent || (there == EntryKind::file && may_replace);
    if (!is_free)
        return cannot_create(
            file.shown(),
            {.code = ErrorCode::already_exists,
             .what = "exists already",
             .remedy = there == EntryKind::file ? "give a new file, or replace this one with --force"
                                                : "give a new file"});
    auto folder = file.parent_to_write();
    if (!folder) return refused(file, folder.error());
    const std::string draft = draft_of(file.filename());
    if (const auto removed = folder->remove(draft); !removed) return refused(file, removed.error());
    auto created = folder->create_new(draft);
    if (!created) return refused(file, created.error());
    return OutputFile(std::move(*folder), file.filename(), std::move(*created));
}

OutputFile::OutputFile(OpenFolder folder, std::string name, OpenFile file)
    : folder_(std::move(folder)), name_(std::move(name)), file_(std::move(file)) {
    unfinished_.emplace(folder_, draft_of(name_));
}

OutputFile::~OutputFile() {
    if (file_ && file_->descriptor() >= 0) (void)folder_.remove(draft_of(name_));
}

bool OutputFile::write(std::string_view bytes) {
    while (!bytes.empty() && error_number_ == 0) {
        const ssize_t count = ::write(file_->descriptor(), bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) error_number_ = errno;
        bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    }
    return error_number_ == 0;
}

Unexpected<AppError> OutputFile::failure(int error_number) const {
    return cannot_create(folder_.shown(name_),
                         {.code = ErrorCode::system_error,
                          .what = std::string("cannot be written (") + std::strerror(error_number) + ")",
                          .remedy = remedy_of(std::error_code(error_number, std::generic_category()))});
}

Status<AppError> OutputFile::commit() {
    if (error_number_ == 0 && ::fsync(file_->descriptor()) != 0) error_number_ = errno;
    if (error_number_ != 0) return failure(error_number_);
    const auto not_now = unfinished_->finish();
    file_.reset();
    if (const auto moved = folder_.move(draft_of(name_), name_); !moved) {
        (void)folder_.remove(draft_of(name_));
        return cannot_create(folder_.shown(name_), to_error(moved.error()));
    }
    return Done{};
}

}  // namespace octoskin::bridge
