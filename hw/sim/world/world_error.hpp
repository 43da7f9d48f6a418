// An error of a world file with its place.
#pragma once

#include <filesystem>
#include <string>

namespace octoskin::sim {

struct WorldError {
    std::filesystem::path file;
    std::string element;  ///< "model 'shelf', link 'body', visual 'top'"; empty if it concerns the whole file
    std::string what;
    bool is_reader_missing = false;  ///< the program that reads worlds is missing; the file was not read
    /// "file: element: what".
    [[nodiscard]] std::string message() const;
};

}  // namespace octoskin::sim
