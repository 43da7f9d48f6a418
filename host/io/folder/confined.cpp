#include "host/io/folder/confined.hpp"

#include <optional>
#include <system_error>

namespace octoskin {
namespace {

namespace fs = std::filesystem;

std::optional<FilePlace> in_recording(const fs::path& file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    for (const char* const mark : {"can.log", "meta.yaml"}) {
        std::error_code error;
        // A link of this name counts, too.
        if (!fs::exists(fs::symlink_status(folder / mark, error))) continue;
        return FilePlace(NamedFolder(folder), file.filename());
    }
    return std::nullopt;
}

}  // namespace

FilePlace confined_to_recording(const FilePlace& typed) {
    if (typed.folder() != nullptr || typed.empty()) return typed;
    if (auto place = in_recording(typed.name())) return *place;
    std::error_code error;
    const fs::path behind_links = fs::canonical(typed.name(), error);
    if (error) return typed;
    return in_recording(behind_links).value_or(typed);
}

}  // namespace octoskin
