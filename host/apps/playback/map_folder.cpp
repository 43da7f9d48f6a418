#include "host/apps/playback/map_folder.hpp"

#include "host/io/mapfile/map_file.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDraftFolder = ".octoskin-maps-part";

Unexpected<AppError> fail(const fs::path& place, const std::error_code& error) {
    return unexpected(AppError{ExitCode::cannot_create, place.string() + ": " + error.message()});
}

/// Removed on every way out.
struct DraftFolder {
    fs::path path;
    explicit DraftFolder(fs::path path_in) : path(std::move(path_in)) {}
    DraftFolder(const DraftFolder&) = delete;
    DraftFolder& operator=(const DraftFolder&) = delete;
    ~DraftFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};

}  // namespace

NamedMaps named_maps(const Playback& playback) {
    const MapSet& maps = playback.pipeline.maps();
    NamedMaps named;
    if (maps.depth() != nullptr && playback.outcome.progress.depth_frames > 0)
        named.emplace_back("depth", maps.depth());
    if (maps.proximity() != nullptr) named.emplace_back("proximity", maps.proximity());
    if (maps.fused() != nullptr) named.emplace_back("fused", maps.fused());
    return named;
}

Status<AppError> save_maps(const NamedMaps& maps, const fs::path& folder) {
    const DraftFolder draft(folder / kDraftFolder);
    std::error_code error;
    fs::create_directories(draft.path, error);
    if (error) return fail(folder, error);
    std::vector<std::string> files;
    for (const auto& [name, map] : maps) {
        for (const char* extension : {".ot", ".bt", ".ply"}) {
            files.push_back(name + extension);
            if (const auto saved = save_map(*map, draft.path / files.back()); !saved)
                return unexpected(AppError{ExitCode::cannot_create, saved.error().message});
        }
    }
    for (const std::string& file : files) {
        fs::rename(draft.path / file, folder / file, error);
        if (error) return fail(folder / file, error);
    }
    return Done{};
}

}  // namespace octoskin
