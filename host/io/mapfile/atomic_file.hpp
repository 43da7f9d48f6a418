// Saves files atomically: at every instant a name has the old or the new content, never a mixture. A file is
// written under a temporary name beside it, flushed to the disk, and renamed. Files that belong together are
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

/// The system calls for saving, with their own return values and errno; a test can make any of them fail.
class FileOperations {
  public:
    virtual ~FileOperations() = default;
    /// A new file for writing; a remainder of a killed process under this name is removed first, never
    /// written to.
    virtual int create(const char* path) = 0;
    virtual int open_directory(const char* path) = 0;
    /// Gives the open file the mode of the one at `path`, and its owner where that is permitted; 0 if that
    /// file does not exist.
    virtual int copy_attributes(const char* path, int descriptor) = 0;
    virtual ssize_t write(int descriptor, const void* bytes, std::size_t count) = 0;
    virtual int sync(int descriptor) = 0;
    virtual int close(int descriptor) = 0;
    virtual int rename(const char* from, const char* to) = 0;
    virtual int remove(const char* path) = 0;
};

/// The system's real calls.
[[nodiscard]] FileOperations& posix_file_operations();

enum class SaveStep : std::uint8_t { name, create, attributes, write, sync, close, rename, sync_directory };

struct SaveError {
    SaveStep step{};
    int error_number = 0;  ///< errno of the step; 0 for `name`: the path does not name a file
    std::filesystem::path file;
    /// "out/map.ot: write failed (No space left on device); the old file, if any, is unchanged".
    [[nodiscard]] std::string message() const;
};

[[nodiscard]] Error to_error(const SaveError& error);

/// Which owner and mode the new file gets.
enum class Attributes : std::uint8_t { of_a_new_file, of_the_old_file };

/// A draft of a file: it is written and flushed to the disk under a temporary name beside the file;
/// `put_in_place` renames it. Without that call its destructor removes it. Two drafts of one file at the same
/// time are not supported.
class FileDraft {
  public:
    /// Writes the bytes of `content`, which is called once. Blocks as long as the disk takes. On an error
    /// nothing remains; also if `content` throws, and the exception is passed on. `operations` must outlive
    /// the draft.
    [[nodiscard]] static Result<FileDraft, SaveError> write(
        const FilePlace& file, const ByteSource& content,
        FileOperations& operations = posix_file_operations(),
        Attributes attributes = Attributes::of_a_new_file);
    FileDraft(FileDraft&& other) noexcept;
    FileDraft& operator=(FileDraft&&) = delete;
    ~FileDraft();

    /// CRC-32 (zlib's) of the written bytes; computed at about 400 MB a second.
    [[nodiscard]] std::uint32_t crc() const noexcept;

  private:
    class Partial;
    explicit FileDraft(std::unique_ptr<Partial> partial) noexcept;
    friend Status<SaveError> put_in_place(std::span<FileDraft> drafts);

    std::unique_ptr<Partial> partial_;
};

/// The temporary name of a draft, in the folder of the file.
[[nodiscard]] std::string draft_name_of(const std::string& file);

/// Renames the drafts to their files' names, each once, in this order and without delay, and then waits for
/// the disk. Other hard links of an old file stay unchanged, and a link in the place of a file is replaced,
/// not followed. On an error at `rename` this file and the following ones are unchanged. On an error at
/// `sync_directory` all new files are in place, but may be lost in a power failure.
[[nodiscard]] Status<SaveError> put_in_place(std::span<FileDraft> drafts);

/// Saves the bytes of `content` as `file`, through a draft, and returns their CRC-32. On an error before
/// `sync_directory` the old file is unchanged and nothing else remains.
[[nodiscard]] Result<std::uint32_t, SaveError> save_atomically(
    const FilePlace& file, const ByteSource& content, FileOperations& operations = posix_file_operations(),
    Attributes attributes = Attributes::of_a_new_file);
/// The same for bytes in memory.
[[nodiscard]] Result<std::uint32_t, SaveError> save_atomically(
    const FilePlace& file, std::string_view bytes, FileOperations& operations = posix_file_operations(),
    Attributes attributes = Attributes::of_a_new_file);

/// Removes drafts that a process left in `folder` when it died while saving; returns their number. To be
/// called at start, before any save. `stays` is called for each that cannot be removed.
std::size_t remove_leftovers(const OpenFolder& folder,
                             const std::function<void(const FolderError&)>& stays = {});

}  // namespace octoskin
