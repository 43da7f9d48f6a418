#include "host/lab/study/work_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "host/apps/recording/text_file.hpp"

namespace octoskin {

Result<WorkFolder, AppError> WorkFolder::create(const OpenFolder& parent) {
    const auto failed = [&parent](int error_number) {
        const std::error_code error(error_number, std::generic_category());
        return cannot_create(parent.shown(),
                             {.code = ErrorCode::system_error,
                              .what = "nothing can be written there (" + error.message() + ")",
                              .remedy = remedy_of(error)});
    };
    std::string name = (parent.path_for_libraries() / ".octoskin-work-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) return failed(errno);
    auto folder = parent.open_folder(std::filesystem::path(name).filename());
    if (!folder) return failed(folder.error().error_number);
    return WorkFolder(parent, std::move(*folder));
}

WorkFolder::WorkFolder(OpenFolder parent, OpenFolder folder)
    : parent_(std::move(parent)),
      folder_(std::move(folder)),
      unfinished_(parent_, folder_.shown().filename().string()) {}

WorkFolder::WorkFolder(WorkFolder&& other) noexcept
    : parent_(other.parent_),
      folder_(other.folder_),
      is_moved_from_(std::exchange(other.is_moved_from_, true)),
      unfinished_(std::move(other.unfinished_)) {}

WorkFolder::~WorkFolder() {
    if (!is_moved_from_) static_cast<void>(parent_.remove_all(folder_.shown().filename()));
}

}  // namespace octoskin
