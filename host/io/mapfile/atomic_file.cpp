#include "host/io/mapfile/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <optional>
#include <system_error>
#include <utility>

#include "host/io/mapfile/file_checksum.hpp"

namespace octoskin {
namespace {

constexpr std::string_view kPartialSuffix = ".octoskin-part";

class PosixFileOperations final : public FileOperations {
  public:
    int create(const char* path) override {
        // A symbolic or hard link of this name, possibly a trap, is removed; its target stays unchanged.
        if (::unlink(path) != 0 && errno != ENOENT) return -1;
        return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0644);
    }
    int open_directory(const char* path) override { return ::open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC); }
    int copy_attributes(const char* path, int descriptor) override {
        struct stat old {};
        if (::stat(path, &old) != 0) return errno == ENOENT ? 0 : -1;
        (void)::fchown(descriptor, old.st_uid, old.st_gid);  // only root may change the owner
        constexpr mode_t kPermissions = 0777;
        return ::fchmod(descriptor, old.st_mode & kPermissions);
    }
    ssize_t write(int descriptor, const void* bytes, std::size_t count) override {
        return ::write(descriptor, bytes, count);
    }
    int sync(int descriptor) override { return ::fsync(descriptor); }
    int close(int descriptor) override { return ::close(descriptor); }
    int rename(const char* from, const char* to) override { return std::rename(from, to); }
    int remove(const char* path) override { return ::unlink(path); }
};

const char* name_of(SaveStep step) {
    switch (step) {
        case SaveStep::name:
            return "choosing a file name";
        case SaveStep::create:
            return "creating a file beside it";
        case SaveStep::attributes:
            return "copying its permissions";
        case SaveStep::write:
            return "writing";
        case SaveStep::sync:
            return "flushing to disk";
        case SaveStep::close:
            return "closing";
        case SaveStep::rename:
            return "renaming";
        case SaveStep::sync_directory:
            return "flushing the folder to disk";
    }
    return "saving";
}

}  // namespace

FileOperations& posix_file_operations() {
    static PosixFileOperations operations;  // stateless
    return operations;
}

std::string draft_name_of(const std::string& file) {
    return fmt::format(".{}{}", file, kPartialSuffix);
}

Error to_error(const SaveError& error) {
    const std::string reason = error.error_number == 0 ? "the path does not name a file"
                                                       : std::generic_category().message(error.error_number);
    const char* const outcome = error.step == SaveStep::sync_directory
                                    ? "the new file is in place, but may not survive a power failure"
                                    : "the old file, if any, is unchanged";
    return {.code = error.step == SaveStep::name ? ErrorCode::bad_name : ErrorCode::system_error,
            .what = fmt::format("{} failed ({}); {}", name_of(error.step), reason, outcome),
            .file = error.file};
}

std::string SaveError::message() const {
    return to_error(*this).message();
}

/// The temporary file beside the one that it replaces. Each function returns the failed step; errno has the
/// reason.
class FileDraft::Partial {
  public:
    Partial(FileOperations& operations, OpenFolder folder, const FilePlace& file, Attributes attributes)
        : operations_(operations),
          folder_(std::move(folder)),
          shown_(file.shown()),
          file_(folder_.path_for_libraries() / file.filename()),
          path_(folder_.path_for_libraries() / draft_name_of(file.filename())),
          attributes_(attributes) {}
    ~Partial() {
        if (is_there_) operations_.remove(path_.c_str());
    }
    Partial(const Partial&) = delete;
    Partial& operator=(const Partial&) = delete;

    std::optional<SaveError> write(const ByteSource& content) {
        const int descriptor = operations_.create(path_.c_str());
        if (descriptor < 0) return failed(SaveStep::create);
        is_there_ = true;
        std::optional<SaveError> error;
        try {
            error = fill(descriptor, content);
        } catch (...) {  // no memory for a piece of the content
            operations_.close(descriptor);
            throw;
        }
        // Network file systems may report a write error only at close.
        if (operations_.close(descriptor) != 0 && !error) error = failed(SaveStep::close);
        return error;
    }

    std::optional<SaveError> rename() {
        if (operations_.rename(path_.c_str(), file_.c_str()) != 0) return failed(SaveStep::rename);
        is_there_ = false;
        return std::nullopt;
    }

    /// Makes the rename durable.
    std::optional<SaveError> sync_directory() {
        const int descriptor = operations_.open_directory(folder_.path_for_libraries().c_str());
        if (descriptor < 0) return failed(SaveStep::sync_directory);
        std::optional<SaveError> error;
        if (operations_.sync(descriptor) != 0) error = failed(SaveStep::sync_directory);
        operations_.close(descriptor);
        return error;
    }

    [[nodiscard]] std::uint32_t crc() const noexcept { return crc_; }

  private:
    [[nodiscard]] SaveError failed(SaveStep step) const { return {step, errno, shown_}; }

    std::optional<SaveError> fill(int descriptor, const ByteSource& content) {
        // Before the first byte: a file that only its owner may read must never be readable for others.
        if (attributes_ == Attributes::of_the_old_file &&
            operations_.copy_attributes(file_.c_str(), descriptor) != 0)
            return failed(SaveStep::attributes);
        std::optional<SaveError> error;
        content([&](std::string_view bytes) {
            crc_ = file_checksum(bytes, crc_);
            if (!error) error = write_all(descriptor, bytes);
            return !error;
        });
        if (!error && operations_.sync(descriptor) != 0) error = failed(SaveStep::sync);
        return error;
    }

    std::optional<SaveError> write_all(int descriptor, std::string_view bytes) {
        while (!bytes.empty()) {
            const ssize_t written = operations_.write(descriptor, bytes.data(), bytes.size());
            if (written < 0 && errno == EINTR) continue;
            if (written == 0) errno = EIO;  // no progress without an error: do not loop forever
            if (written <= 0) return failed(SaveStep::write);
            bytes.remove_prefix(static_cast<std::size_t>(written));
        }
        return std::nullopt;
    }

    FileOperations& operations_;
    OpenFolder folder_;
    std::filesystem::path shown_;
    std::filesystem::path file_;  ///< this path and the next go through the folder's descriptor
    std::filesystem::path path_;
    Attributes attributes_;
    std::uint32_t crc_ = 0;
    bool is_there_ = false;
};

FileDraft::FileDraft(std::unique_ptr<Partial> partial) noexcept : partial_(std::move(partial)) {}
FileDraft::FileDraft(FileDraft&&) noexcept = default;
FileDraft::~FileDraft() = default;

Result<FileDraft, SaveError> FileDraft::write(const FilePlace& file, const ByteSource& content,
                                              FileOperations& operations, Attributes attributes) {
    const std::string name = file.filename();
    if (name.empty() || name == "." || name == "..")
        return unexpected(SaveError{SaveStep::name, 0, file.shown()});
    auto folder = file.parent_to_write();
    if (!folder) return unexpected(SaveError{SaveStep::create, folder.error().error_number, file.shown()});
    auto partial = std::make_unique<Partial>(operations, std::move(*folder), file, attributes);
    if (auto error = partial->write(content)) return unexpected(std::move(*error));
    return FileDraft(std::move(partial));
}

std::uint32_t FileDraft::crc() const noexcept {
    return partial_->crc();
}

Status<SaveError> put_in_place(std::span<FileDraft> drafts) {
    for (FileDraft& draft : drafts)
        if (auto error = draft.partial_->rename()) return unexpected(std::move(*error));
    for (FileDraft& draft : drafts)
        if (auto error = draft.partial_->sync_directory()) return unexpected(std::move(*error));
    return Done{};
}

Result<std::uint32_t, SaveError> save_atomically(const FilePlace& file, const ByteSource& content,
                                                 FileOperations& operations, Attributes attributes) {
    auto draft = FileDraft::write(file, content, operations, attributes);
    if (!draft) return unexpected(draft.error());
    if (const auto put = put_in_place({&*draft, 1}); !put) return unexpected(put.error());
    return draft->crc();
}

Result<std::uint32_t, SaveError> save_atomically(const FilePlace& file, std::string_view bytes,
                                                 FileOperations& operations, Attributes attributes) {
    return save_atomically(
        file, [bytes](const ByteSink& sink) { (void)sink(bytes); }, operations, attributes);
}

std::size_t remove_leftovers(const OpenFolder& folder, const std::function<void(const FolderError&)>& stays) {
    std::size_t removed = 0;
    const auto names = folder.names();
    if (!names) return removed;
    for (const std::string& name : *names) {
        const bool is_leftover = name.starts_with('.') && name.ends_with(kPartialSuffix) &&
                                 folder.kind_of(name) == EntryKind::file;
        if (!is_leftover) continue;
        const auto gone = folder.remove(name);
        if (gone) ++removed;
        if (!gone && stays) stays(gone.error());
    }
    return removed;
}

}  // namespace octoskin
