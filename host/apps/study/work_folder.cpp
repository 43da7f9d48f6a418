#include "host/apps/study/work_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include "host/apps/recording/text_file.hpp"

namespace octoskin {

Result<WorkFolder, AppError> WorkFolder::create(const std::filesystem::path& parent) {
    std::string name = (parent / ".octoskin-work-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
        const std::error_code error(errno, std::generic_category());
        return cannot_create(parent,
                             "nothing can be written there (" + error.message() + "): " + remedy_of(error));
    }
    return WorkFolder(name);
}

WorkFolder::WorkFolder(std::filesystem::path path) : path_(std::move(path)), unfinished_(path_) {}

WorkFolder::WorkFolder(WorkFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), unfinished_(std::move(other.unfinished_)) {}

WorkFolder::~WorkFolder() {
    if (path_.empty()) return;
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace octoskin
