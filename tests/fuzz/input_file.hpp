// The fuzzer's bytes as a file, for readers that take a path.
#pragma once

#include <unistd.h>

#include <cassert>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace octoskin::fuzz {

/// A directory of this process's own, removed at its end.
class InputDirectory {
  public:
    InputDirectory()
        : path_(std::filesystem::temp_directory_path() / ("octoskin-fuzz-" + std::to_string(getpid()))) {
        std::filesystem::create_directories(path_);
    }
    InputDirectory(const InputDirectory&) = delete;
    InputDirectory& operator=(const InputDirectory&) = delete;
    ~InputDirectory() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    /// Writes `content` over the file of that name and returns its path.
    std::filesystem::path write(const std::string& name, std::string_view content) const {
        std::filesystem::path file = path_ / name;
        // ext4 writes a file to the disk when it is emptied and filled again, but not a new one: 100 times
        // faster.
        std::filesystem::remove(file);
        std::ofstream out(file, std::ios::binary | std::ios::trunc);
        out << content;
        out.close();
        assert(out);
        return file;
    }
    /// Makes a file of tests/data reachable from the input by a relative path.
    void offer(const std::filesystem::path& file) const {
        std::filesystem::create_symlink(file, path_ / file.filename());
    }

  private:
    std::filesystem::path path_;
};

}  // namespace octoskin::fuzz
