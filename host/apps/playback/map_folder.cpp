#include "host/apps/playback/map_folder.hpp"

#include "host/io/mapfile/map_file.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

/// Maps of earlier runs that are not among the new ones.
struct OtherMaps {
    SavedMaps reported;
    std::vector<fs::path> retired;
};

OtherMaps look_at_others(const OpenFolder& folder, const MapOrigin& origin) {
    const auto former = read_map_origin(NamedFolder(folder));
    OtherMaps others;
    for (const std::string& name : map_file_names()) {
        const FilePlace map(folder, name);
        if (origin.maps.contains(name) || !map.is_there()) continue;
        // Only a map that is byte for byte the one of an earlier replay.
        const bool is_ours =
            former && *former && (*former)->maps.contains(name) && !fault_of_map(map, **former);
        (is_ours ? others.reported.removed : others.reported.foreign).push_back(name);
        if (is_ours) others.retired.emplace_back(name);
    }
    return others;
}

}  // namespace

NamedMaps named_maps(const Playback& playback) {
    NamedMaps named;
    for (const FedMap& fed : playback.pipeline.maps()) {
        const bool has_no_frames = playback.outcome.progress.depth_frames == 0;
        if (fed.feed == MapFeed::camera && has_no_frames) continue;
        if (fed.feed == MapFeed::ranges && playback.rig.nodes.empty()) continue;
        named.emplace_back(name_of(fed.feed), &fed.map);
    }
    return named;
}

Status<AppError> check_map_places(const OpenFolder& folder) {
    std::vector<fs::path> names{kMapOriginFile};
    for (const std::string& name : map_file_names()) names.emplace_back(name);
    return FileSet::check_places(folder, names);
}

Result<MapFolder, AppError> MapFolder::open(const FilePlace& folder) {
    auto files = FileSet::begin(folder);
    if (!files) return unexpected(files.error());
    if (const auto checked = check_map_places(files->folder()); !checked) return unexpected(checked.error());
    return MapFolder(std::move(*files));
}

Result<SavedMaps, AppError> MapFolder::save(const NamedMaps& maps, MapOrigin origin) {
    std::vector<fs::path> files;
    for (const auto& [name, map] : maps) {
        for (const char* extension : {".ot", ".bt", ".ply"}) {
            const FilePlace file(files_.draft(), files.emplace_back(name + extension));
            const auto saved = save_map(*map, file);
            if (!saved) return fail(ExitCode::cannot_create, saved.error());
            origin.maps[file.filename()] = *saved;
        }
    }
    const OtherMaps others = look_at_others(files_.folder(), origin);
    if (const auto written = write_map_origin({files_.draft(), kMapOriginFile}, origin); !written)
        return unexpected(written.error());
    files.emplace_back(kMapOriginFile);
    if (const auto committed = files_.commit(files, others.retired); !committed)
        return unexpected(committed.error());
    return others.reported;
}

}  // namespace octoskin
