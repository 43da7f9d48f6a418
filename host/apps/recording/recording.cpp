#include "host/apps/recording/recording.hpp"

#include <yaml-cpp/yaml.h>

#include <fstream>
#include <set>
#include <utility>

#include "host/apps/recording/file_set.hpp"
#include "host/apps/recording/given_bag.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin {
namespace {

constexpr const char* kSchema = "octoskin-recording/1";
constexpr std::int64_t kCrcMax = 0xFFFF'FFFF;
constexpr const char* kMetaMissing =
    "its minimum content is two lines, 'schema: octoskin-recording/1' and 'source: robot'";
constexpr const char* kDirectoryMissing =
    "`octoskin record` (of a running daemon) and `octoskin-lab simulate` make recordings";
constexpr const char* kLogMissing =
    "this is not a recording of `octoskin record` (of a running daemon) or `octoskin-lab simulate`; by hand, "
    "can.log is the output of `candump -L`. A data set has depth.txt, associations.txt or frame-*.depth.png, "
    "and the poses of its camera (docs/how-to/record-and-replay.md)";

/// The error of a file that does not exist.
Error missing_file(const std::string& remedy) {
    return {.code = ErrorCode::not_found, .what = "no such file", .remedy = remedy};
}

Unexpected<Error> failure(const std::filesystem::path& file, Error error) {
    return unexpected(in_file(std::move(error), file));
}

Unexpected<Error> failure(const FolderError& error) {
    return unexpected(to_error(error));
}

/// Of a file where a recording's directory is expected.
std::string remedy_for_file(const std::filesystem::path& file) {
    if (is_named_as_bag(file))
        return "make a recording of it: `octoskin bridge import " + file.string() + " DIR --rig RIG`";
    return "give the recording's directory, " + std::filesystem::absolute(file).parent_path().string();
}

/// Checks that it is a folder, and complete.
Status<Error> check_folder(const RecordingPaths& recording) {
    const auto folder = recording.folder.open();
    if (folder) {
        if (folder->kind_of(FileSet::kReadyFolder) == EntryKind::absent) return Done{};
        return failure(recording.directory,
                       {.code = ErrorCode::unfinished_move,
                        .what = "an octoskin was killed while it put new files into place",
                        .remedy = "`octoskin repair " + recording.directory.string() + "` completes that"});
    }
    if (folder.error().fault == FolderFault::not_a_folder) {
        return failure(recording.directory, {.code = ErrorCode::wrong_kind_of_file,
                                             .what = "is a file",
                                             .remedy = remedy_for_file(recording.directory)});
    }
    if (folder.error().fault == FolderFault::absent) {
        return failure(
            recording.directory,
            {.code = ErrorCode::not_found, .what = "no such directory", .remedy = kDirectoryMissing});
    }
    return failure(recording.directory, to_error(folder.error()));
}

Status<Error> check_kind(const FilePlace& place, EntryKind expected) {
    const EntryKind kind = place.kind();
    if (kind == EntryKind::absent || kind == expected) return Done{};
    const auto opened = place.open();
    if (!opened && opened.error().fault == FolderFault::link) return failure(opened.error());
    const bool is_file = expected == EntryKind::file;
    return failure(place.shown(),
                   {.code = ErrorCode::wrong_kind_of_file,
                    .what = is_file ? "is not a regular file" : "is not a folder",
                    .remedy = is_file ? "move it away, or put the recorded file there"
                                      : "move it away, or put the folder of the cameras' files there"});
}

/// Checks that only regular files are at the names of files, and a folder at that of the cameras' files.
Status<Error> check_kinds(const RecordingPaths& recording) {
    const FilePlace depth = recording.file(RecordingPaths::kDepthFolder);
    if (const auto checked = check_kind(depth, EntryKind::folder); !checked) return checked;
    for (const FilePlace& file : recording.files()) {
        if (const auto checked = check_kind(file, EntryKind::file); !checked) return checked;
    }
    return Done{};
}

/// Checks that the camera has both of its files, or none.
Status<Error> check_depth(const RecordingPaths& recording, const std::string& camera) {
    const FilePlace oni = recording.depth(camera);
    const FilePlace epoch = recording.depth_epoch(camera);
    const bool has_depth = oni.is_there();
    if (has_depth == epoch.is_there()) return Done{};
    const FilePlace& missing = has_depth ? epoch : oni;
    const FilePlace& lonely = has_depth ? oni : epoch;
    const std::string rest = camera.empty() ? "the ranges alone" : "without this camera";
    return failure(missing.shown(),
                   {.code = ErrorCode::not_found,
                    .what = "no such file, but " + lonely.name().string() + " exists",
                    .remedy = "put it there, too, or move the other file away to map " + rest});
}

void write_source(YAML::Emitter& out, const std::string& key, const SourceFile& source) {
    if (source.file.empty()) return;
    out << YAML::Key << key << YAML::Value;
    rig::emit_text(out, source.file.string());
    if (source.crc32) out << YAML::Key << key + "_crc32" << YAML::Value << crc_text(*source.crc32);
}

SourceFile read_source(const rig::Table& table, const std::string& key) {
    SourceFile source{table.text(key), std::nullopt};
    const std::string crc = key + "_crc32";
    if (table.find(crc) != nullptr) source.crc32 = table.integer<std::uint32_t>(crc, {0, kCrcMax});
    return source;
}

RecordingMeta read_checked(const FilePlace& file) {
    const rig::Value document = rig::load_document(file);
    const rig::Table table(document, "",
                           {"schema", "made_by", "source", "world", "world_crc32", "scenario",
                            "scenario_crc32", "rig", "rig_crc32", "scene_crc32", "seed", "duration_s",
                            "can_frames", "depth_frames", "is_depth_noise_free"});
    static_cast<void>(table.choice<bool>("schema", {{kSchema, true}}));
    constexpr double kDurationMax_s = 1e9;
    RecordingMeta meta;
    meta.made_by = table.text("made_by");
    if (table.find("source") != nullptr)
        meta.source = table.choice<std::string>("source", {{"robot", "robot"}, {"simulation", "simulation"}});
    meta.world = read_source(table, "world");
    meta.scenario = read_source(table, "scenario");
    meta.rig = read_source(table, "rig");
    if (table.find("scene_crc32") != nullptr)
        meta.scene_crc32 = table.integer<std::uint32_t>("scene_crc32", {0, kCrcMax});
    if (table.find("seed") != nullptr) meta.seed = table.unsigned_integer("seed", 0);
    meta.is_depth_noise_free = table.flag("is_depth_noise_free", false);
    meta.can_frames = table.unsigned_integer("can_frames", 0);
    meta.depth_frames = table.unsigned_integer("depth_frames", 0);
    meta.duration_s = table.number("duration_s", {0.0, kDurationMax_s}, 0.0);
    return meta;
}

}  // namespace

std::vector<FilePlace> RecordingPaths::files() const {
    std::vector<FilePlace> files{can_log(),  depth(),   depth_epoch(), rig(),         robot(),
                                 order(),    mapping(), first_map(),   first_state(), last_map(),
                                 scenario(), world(),   motion(),      meta()};
    for (const std::string& camera : cameras()) {
        if (camera.empty()) continue;
        files.push_back(depth(camera));
        files.push_back(depth_epoch(camera));
    }
    for (FilePlace& mesh : meshes()) files.push_back(std::move(mesh));
    return files;
}

std::string RecordingPaths::depth_name(std::string_view camera, std::string_view ending) {
    std::string name = kDepthFolder;
    if (!camera.empty()) name.append("/").append(camera);
    return name.append(ending);
}

std::vector<std::string> RecordingPaths::cameras() const {
    std::set<std::string> cameras;
    if (depth().is_there() || depth_epoch().is_there()) cameras.emplace();
    const auto opened = file(kDepthFolder).open_folder();
    const auto names = opened ? opened->names() : unexpected(opened.error());
    if (names) {
        for (const std::string& name : *names)
            if (std::string camera = camera_of_file(name); !camera.empty()) cameras.insert(std::move(camera));
    }
    return {cameras.begin(), cameras.end()};
}

std::vector<FilePlace> RecordingPaths::meshes() const {
    const auto opened = folder.open();
    const auto names = opened ? opened->names() : unexpected(opened.error());
    std::vector<FilePlace> meshes;
    if (!names) return meshes;
    for (const std::string& name : *names) {
        if (is_scene_mesh(name)) meshes.push_back(file(name));
    }
    return meshes;
}

Status<Error> write_meta(const RecordingPaths& recording, const RecordingMeta& meta) {
    YAML::Emitter out;
    out << YAML::BeginMap;
    out << YAML::Key << "schema" << YAML::Value << kSchema;
    out << YAML::Key << "made_by" << YAML::Value;
    rig::emit_text(out, meta.made_by);
    if (!meta.source.empty()) out << YAML::Key << "source" << YAML::Value << meta.source;
    write_source(out, "world", meta.world);
    write_source(out, "scenario", meta.scenario);
    write_source(out, "rig", meta.rig);
    if (meta.scene_crc32) out << YAML::Key << "scene_crc32" << YAML::Value << crc_text(*meta.scene_crc32);
    if (meta.seed) out << YAML::Key << "seed" << YAML::Value << *meta.seed;
    out << YAML::Key << "is_depth_noise_free" << YAML::Value << meta.is_depth_noise_free;
    out << YAML::Key << "can_frames" << YAML::Value << meta.can_frames;
    out << YAML::Key << "depth_frames" << YAML::Value << meta.depth_frames;
    out << YAML::Key << "duration_s" << YAML::Value << meta.duration_s;
    out << YAML::EndMap;
    const auto created = recording.meta().create_anew();
    if (!created) return failure(created.error());
    std::ofstream file(created->path_for_libraries());
    file << out.c_str() << '\n';
    file.close();
    if (!file)
        return failure(recording.meta().shown(), {.code = ErrorCode::system_error,
                                                  .what = "cannot write",
                                                  .remedy = "is the disk full, do you own the folder?"});
    return Done{};
}

Result<RecordingMeta, Error> read_meta(const RecordingPaths& recording) {
    const FilePlace place = recording.meta();
    if (!place.is_there()) return failure(place.shown(), missing_file(kMetaMissing));
    try {
        return read_checked(place);
    } catch (const Error& error) {
        return unexpected(error);
    }
}

Status<Error> check_recording(const RecordingPaths& recording, bool is_rig_given) {
    if (const auto checked = check_folder(recording); !checked) return checked;
    if (const auto checked = check_kinds(recording); !checked) return checked;
    // An experiment leaves a folder that contains a recording.
    if (!recording.can_log().is_there() && FilePlace(recording.folder, "recording/can.log").is_there()) {
        return failure(recording.can_log().shown(),
                       missing_file("did you mean " + (recording.directory / "recording").string() + "?"));
    }
    const std::pair<FilePlace, const char*> needed[] = {{recording.can_log(), kLogMissing},
                                                        {recording.rig(), "put the rig there, or give --rig"},
                                                        {recording.meta(), kMetaMissing}};
    for (const auto& [file, remedy] : needed) {
        if (is_rig_given && file == recording.rig()) continue;
        if (!file.is_there()) return failure(file.shown(), missing_file(remedy));
    }
    for (const std::string& camera : recording.cameras()) {
        if (const auto checked = check_depth(recording, camera); !checked) return checked;
    }
    return Done{};
}

}  // namespace octoskin
