#include "host/apps/study/work_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

namespace octoskin {

Result<WorkFolder, AppError> WorkFolder::create(const std::filesystem::path& parent) {
    std::string name = (parent / ".octoskin-work-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) return cannot_create(name, std::strerror(errno));
    return WorkFolder(name);
}

WorkFolder::WorkFolder(std::filesystem::path path) : path_(std::move(path)) {}

WorkFolder::WorkFolder(WorkFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}

WorkFolder::~WorkFolder() {
    if (path_.empty()) return;
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace octoskin
