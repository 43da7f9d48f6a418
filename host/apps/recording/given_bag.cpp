#include "host/apps/recording/given_bag.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace octoskin {
namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& named) {
    std::error_code error;
    return fs::is_directory(named, error);
}

bool is_of_ros(const OpenFolder& folder) {
    return folder.kind_of("metadata.yaml") != EntryKind::absent &&
           folder.kind_of("can.log") == EntryKind::absent;
}

}  // namespace

bool is_named_as_bag(const fs::path& file) {
    return file.extension() == ".mcap";
}

Result<std::optional<FilePlace>, AppError> find_bag(const fs::path& named) {
    using Found = std::optional<FilePlace>;
    if (!is_folder(named)) return is_named_as_bag(named) ? Found(named) : Found();
    auto folder = OpenFolder::open(named, FolderAccess::read);
    if (!folder || !is_of_ros(*folder)) return Found();
    const auto names = folder->names();
    std::vector<std::string> bags;
    if (names) std::ranges::copy_if(*names, std::back_inserter(bags), is_named_as_bag);
    if (bags.size() > 1)
        return fail(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                      .what = "is a bag of several files",
                                      .value = std::to_string(bags.size()),
                                      .remedy = "name one of them, or join them with `ros2 bag convert`",
                                      .file = named});
    return bags.empty() ? Found() : Found(FilePlace(std::move(*folder), bags.front()));
}

Result<FilePlace, AppError> given_bag(const fs::path& named) {
    auto found = find_bag(named);
    if (!found) return unexpected(found.error());
    if (*found) return std::move(**found);
    if (!is_folder(named)) return FilePlace(named);
    return fail(
        ExitCode::usage,
        {.code = ErrorCode::wrong_kind_of_file,
         .what = "is no folder of `ros2 bag`: it needs a metadata.yaml and an MCAP file",
         .remedy = "name the MCAP file itself, or write a metadata.yaml with `ros2 bag reindex -s mcap`",
         .file = named});
}

FilePlace maps_beside(const FilePlace& bag) {
    return bag.beside(fs::path(bag.filename()).replace_extension(".maps"));
}

}  // namespace octoskin
