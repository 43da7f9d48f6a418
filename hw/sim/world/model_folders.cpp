#include "hw/sim/world/model_folders.hpp"

#include <algorithm>
#include <cstdlib>
#include <system_error>

namespace octoskin::sim {

namespace fs = std::filesystem;

std::vector<fs::path> model_folders() {
    std::vector<fs::path> folders;
    for (const char* variable : kModelFolderVariables) {
        const char* const value = std::getenv(variable);
        std::string_view left = value == nullptr ? "" : value;
        while (!left.empty()) {
            const std::string_view folder = left.substr(0, left.find(':'));
            if (!folder.empty()) folders.emplace_back(folder);
            left.remove_prefix(std::min(folder.size() + 1, left.size()));
        }
    }
    return folders;
}

std::optional<fs::path> find_model_file(std::string_view uri) {
    if (!uri.starts_with(kModelScheme)) return std::nullopt;
    for (const fs::path& folder : model_folders()) {
        std::error_code error;
        fs::path found = folder / uri.substr(kModelScheme.size());
        if (fs::exists(found, error)) return found;
    }
    return std::nullopt;
}

void put_model_folders_first(const std::vector<std::string>& folders) {
    const char* const before = std::getenv(kModelFolderVariables[0]);
    std::string all;
    for (const std::string& folder : folders) all += folder + ":";
    ::setenv(kModelFolderVariables[0], (all + (before == nullptr ? "" : before)).c_str(), 1);
}

}  // namespace octoskin::sim
