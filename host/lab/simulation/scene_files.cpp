#include "host/lab/simulation/scene_files.hpp"

#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "common/wire/crc.hpp"
#include "host/apps/recording/file_set.hpp"
#include "host/apps/recording/text_file.hpp"
#include "hw/sim/world/solids_bytes.hpp"
#include "hw/sim/world/world_copy.hpp"

namespace octoskin {
namespace {

Status<AppError> write_files(const Scene& scene, const sim::WorldCopy& world, const RecordingPaths& to) {
    for (const sim::MeshCopy& mesh : world.meshes) {
        if (auto written = write_text(to.file(mesh.name), mesh.bytes); !written) return written;
    }
    if (auto written = write_text(to.world(), world.sdf); !written) return written;
    if (!scene.scenario.world_motion.empty()) {
        if (auto copied = copy_file(scene.scenario.world_motion, to.motion()); !copied) return copied;
    }
    return write_text(to.scenario(), scene.scenario.standalone_text);
}

std::string bytes_of(const sim::World& world) {
    return sim::to_bytes(sim::SolidsOfFile{world.solids()});
}

/// The difference between the scene and the scene read back from its files; empty: none.
SceneGap difference(const Scene& scene, const RecordingPaths& recording) {
    const auto again = read_scene(recording.scenario(), {});
    if (!again) return again.error().message();
    if (again->scenario.standalone_text != scene.scenario.standalone_text)
        return "its scenario reads back differently from there";
    if (bytes_of(again->world) != bytes_of(scene.world)) return "its world reads back differently from there";
    return std::nullopt;
}

Status<AppError> remove_files(const RecordingPaths& recording, const sim::WorldCopy& world) {
    const auto folder = recording.folder.open();
    if (!folder) return fail(ExitCode::cannot_create, to_error(folder.error()));
    std::vector<FilePlace> files{recording.scenario(), recording.world(), recording.motion()};
    for (const sim::MeshCopy& mesh : world.meshes) files.push_back(recording.file(mesh.name));
    for (const FilePlace& file : files) {
        if (const auto removed = folder->remove(file.name()); !removed)
            return fail(ExitCode::cannot_create, to_error(removed.error()));
    }
    return Done{};
}

/// A recording from an untrusted source may contain an endless file: reads no more than simulate writes.
std::optional<std::string> read_bounded(const FilePlace& file) {
    const std::size_t bytes_max = is_scene_mesh(file.filename()) ? sim::kMeshBytesMax : sim::kWorldBytesMax;
    const auto opened = file.open();
    auto bytes = opened ? opened->read(bytes_max) : unexpected(opened.error());
    if (!bytes || bytes->size() > bytes_max) return std::nullopt;
    return std::move(*bytes);
}

std::span<const std::uint8_t> as_bytes(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

Result<SceneGap, AppError> write_scene(const Scene& scene, const RecordingPaths& recording,
                                       const std::function<void(const std::string&)>& on_warning) {
    const auto world = sim::copy_of_world(scene.world_place, scene.world.meshes(), scene.world.written_out());
    if (!world) return SceneGap(world.error());
    if (on_warning && !world->left_out.empty()) {
        on_warning(scene.world_place.shown().string() + ": mesh '" + world->left_out.front() + "' (" +
                   std::to_string(world->left_out.size()) +
                   "in all) does not belong to a visual and is left out of the recording");
    }
    if (const auto written = write_files(scene, *world, recording); !written)
        return unexpected(written.error());
    SceneGap gap = difference(scene, recording);
    if (!gap) return gap;
    if (const auto removed = remove_files(recording, *world); !removed) return unexpected(removed.error());
    return gap;
}

std::optional<std::uint32_t> crc32_of_scene(const RecordingPaths& recording) {
    if (!recording.scenario().is_there() || !recording.world().is_there()) return std::nullopt;
    std::vector<FilePlace> files{recording.scenario(), recording.world()};
    if (recording.motion().is_there()) files.push_back(recording.motion());
    std::vector<FilePlace> meshes = recording.meshes();
    if (meshes.size() > sim::kMeshesMax) return std::nullopt;
    std::move(meshes.begin(), meshes.end(), std::back_inserter(files));
    std::size_t bytes_left = sim::kMeshesBytesMax + 3 * sim::kWorldBytesMax;
    std::uint32_t crc = 0;
    for (const FilePlace& file : files) {
        const auto bytes = read_bounded(file);
        if (!bytes || bytes->size() > bytes_left) return std::nullopt;
        bytes_left -= bytes->size();
        const std::string entry = file.filename() + " " + crc_text(crc32(as_bytes(*bytes))) + "\n";
        crc = crc32(as_bytes(entry), crc);
    }
    return crc;
}

}  // namespace octoskin
