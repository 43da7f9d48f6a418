#include "host/lab/world_reader/folder_files.hpp"

#include <utility>

namespace octoskin::sim {

namespace fs = std::filesystem;

Result<std::unique_ptr<FolderFiles>, Error> FolderFiles::open(const fs::path& folder) {
    auto opened = OpenFolder::open(folder, FolderAccess::read);
    if (!opened) return unexpected(to_error(opened.error()));
    return std::unique_ptr<FolderFiles>(new FolderFiles(std::move(*opened)));
}

Result<fs::path, std::string> FolderFiles::openable(const fs::path& file) const {
    const fs::path name = file.lexically_normal();
    const auto before = opened_.find(name);
    if (before != opened_.end()) return before->second.path_for_libraries();
    auto opened = folder_.open_file(name);
    if (!opened) return unexpected(opened.error().reason());
    return opened_.emplace(name, std::move(*opened)).first->second.path_for_libraries();
}

}  // namespace octoskin::sim
