// Saves files so that at every instant a name has the old content or the new, never for a mixture:
// written under another name beside it, flushed to the disk, then renamed. Several that belong together are
// all written before the first is renamed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <sys/types.h>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/folder/folder_error.hpp"
#include "host/io/mapfile/byte_sink.hpp"

namespace octoskin {

/// The system calls that saving needs, with their own return values and errno; a test can make any of them
/// fail.
class FileOperations {
  public:
    virtual ~FileOperations() = default;
    /// A new file to write to; what a killed process left under this name is removed first, never written to.
    virtual int create(const char* path) = 0;
    virtual int open_directory(const char* path) = 0;
    /// Gives the open file the mode of the one at `path`, and its owner where that is permitted; 0 if there
    /// is no such file.
    virtual int copy_attributes(const char* path, int descriptor) = 0;
    virtual ssize_t write(int descriptor, const void* bytes, std::size_t count) = 0;
    virtual int sync(int descriptor) = 0;
    virtual int close(int descriptor) = 0;
    virtual int rename(const char* from, const char* to) = 0;
    virtual int remove(const char* path) = 0;
};

/// The real ones.
[[nodiscard]] FileOperations& posix_file_operations();

enum class SaveStep : std::uint8_t { name, create, attributes, write, sync, close, rename, sync_directory };

struct SaveError {
    SaveStep step{};
    int error_number = 0;  ///< errno of the step; 0 for `name`: the path names no file
    std::filesystem::path file;
    /// "out/map.ot: write failed (No space left on device); the old file is untouched".
    [[nodiscard]] std::string message() const;
};

/// Whose a file is and who may read it.
enum class Attributes : std::uint8_t { of_a_new_file, of_the_old_file };

/// What a file is to become: written and flushed to the disk under another name beside it, until
/// `put_in_place` gives it the file's. What is dropped before that is removed. Two drafts of one file at once
/// are not supported.
class FileDraft {
  public:
    /// Writes what `content` gives; it is asked for once. Blocks for as long as the disk takes. On an error,
    /// and if `content` throws, which passes through, nothing is left behind. `operations` must outlive the
    /// draft.
    [[nodiscard]] static Result<FileDraft, SaveError> write(
        const FilePlace& file, const ByteSource& content,
        FileOperations& operations = posix_file_operations(),
        Attributes attributes = Attributes::of_a_new_file);
    FileDraft(FileDraft&& other) noexcept;
    FileDraft& operator=(FileDraft&&) = delete;
    ~FileDraft();

    /// CRC-32 (zlib's) of what was written, some 400 MB a second.
    [[nodiscard]] std::uint32_t crc() const noexcept;

  private:
    class Partial;
    explicit FileDraft(std::unique_ptr<Partial> partial) noexcept;
    friend Status<SaveError> put_in_place(std::span<FileDraft> drafts);

    std::unique_ptr<Partial> partial_;
};

/// The name of a file's draft, beside it.
[[nodiscard]] std::string draft_name_of(const std::string& file);

/// Gives the drafts their files' names, once each, in this order and one directly after the other, and then
/// waits for the disk. Of a file with several names only this one changes, and a link in the file's place is
/// replaced, not followed. On an error at `rename` that file and those behind it are as they were; at
/// `sync_directory` all new ones are in place, but may be lost if power fails now.
[[nodiscard]] Status<SaveError> put_in_place(std::span<FileDraft> drafts);

/// Saves what `content` gives as `file`, by a draft that is put in its place, and gives its CRC-32. On an
/// error before `sync_directory` the old file is as it was and nothing is left behind.
[[nodiscard]] Result<std::uint32_t, SaveError> save_atomically(
    const FilePlace& file, const ByteSource& content, FileOperations& operations = posix_file_operations(),
    Attributes attributes = Attributes::of_a_new_file);
/// The same with all of its bytes.
[[nodiscard]] Result<std::uint32_t, SaveError> save_atomically(
    const FilePlace& file, std::string_view bytes, FileOperations& operations = posix_file_operations(),
    Attributes attributes = Attributes::of_a_new_file);

/// Removes what a process left in `folder` when it died while saving; returns how many. To be called at
/// start, before any save. `stays` is told of each that cannot be removed.
std::size_t remove_leftovers(const OpenFolder& folder,
                             const std::function<void(const FolderError&)>& stays = {});

}  // namespace octoskin
