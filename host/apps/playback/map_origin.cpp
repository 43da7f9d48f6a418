#include "host/apps/playback/map_origin.hpp"

#include <yaml-cpp/yaml.h>

#include <limits>

#include "host/apps/recording/text_file.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "octoskin-maps/1";
constexpr std::int64_t kCrcMax = std::numeric_limits<std::uint32_t>::max();

std::map<std::string, std::uint32_t> read_maps(const rig::Table& top) {
    const rig::Table table(top.require("maps"), "maps",
                           {"depth.ot", "depth.bt", "depth.ply", "proximity.ot", "proximity.bt",
                            "proximity.ply", "fused.ot", "fused.bt", "fused.ply"});
    std::map<std::string, std::uint32_t> maps;
    for (const std::string& name : map_file_names()) {
        if (table.find(name) != nullptr) maps[name] = table.integer<std::uint32_t>(name, {0, kCrcMax});
    }
    return maps;
}

MapOrigin read_checked(const FilePlace& file) {
    const rig::Value document = rig::load_document(file);
    const rig::Table table(document, "",
                           {"schema", "made_by", "recording", "recording_crc32", "rig", "rig_hash", "robot",
                            "robot_crc32", "configuration", "mapping", "maps"});
    static_cast<void>(table.choice<bool>("schema", {{kSchema, true}}));
    MapOrigin origin;
    origin.made_by = table.text("made_by");
    origin.recording = table.text("recording");
    origin.recording_crc32 = table.integer<std::uint32_t>("recording_crc32", {0, kCrcMax});
    origin.rig = table.text("rig");
    origin.rig_hash = table.integer<std::uint32_t>("rig_hash", {0, kCrcMax});
    origin.robot = table.text("robot");
    if (table.find("robot_crc32") != nullptr)
        origin.robot_crc32 = table.integer<std::uint32_t>("robot_crc32", {0, kCrcMax});
    origin.configuration = table.text("configuration");
    origin.mapping = table.text("mapping");
    origin.maps = read_maps(table);
    return origin;
}

}  // namespace

std::vector<std::string> map_file_names() {
    std::vector<std::string> names;
    for (const char* map : {"depth", "proximity", "fused"}) {
        for (const char* extension : {".ot", ".bt", ".ply"}) names.push_back(std::string(map) + extension);
    }
    return names;
}

std::optional<std::uint32_t> crc32_of_recording(const RecordingPaths& recording, const BytesReport& report) {
    std::vector<FilePlace> files = {recording.can_log()};
    const auto add = [&files](const FilePlace& file) {
        if (file.is_there()) files.push_back(file);
    };
    for (const std::string& camera : recording.cameras()) {
        add(recording.depth(camera));
        add(recording.depth_epoch(camera));
    }
    for (const FilePlace& file : {recording.order(), recording.first_map(), recording.first_state()})
        add(file);
    return crc32_of(files, report);
}

Status<AppError> write_map_origin(const FilePlace& file, const MapOrigin& origin) {
    YAML::Emitter out;
    out << YAML::BeginMap;
    const auto put = [&out](const char* key, const std::string& value) {
        out << YAML::Key << key << YAML::Value;
        rig::emit_text(out, value);
    };
    put("schema", kSchema);
    put("made_by", origin.made_by);
    put("recording", origin.recording.string());
    put("recording_crc32", crc_text(origin.recording_crc32));
    put("rig", origin.rig.string());
    put("rig_hash", crc_text(origin.rig_hash));
    put("robot", origin.robot.string());
    if (origin.robot_crc32) put("robot_crc32", crc_text(*origin.robot_crc32));
    put("configuration", origin.configuration);
    out << YAML::Key << "mapping" << YAML::Value << YAML::Literal << origin.mapping;
    out << YAML::Key << "maps" << YAML::Value << YAML::BeginMap;
    for (const auto& [name, crc] : origin.maps) put(name.c_str(), crc_text(crc));
    out << YAML::EndMap << YAML::EndMap;
    return write_text(file, std::string(out.c_str()) + '\n');
}

Result<std::optional<MapOrigin>, AppError> read_map_origin(const NamedFolder& folder) {
    const FilePlace file(folder, kMapOriginFile);
    if (!file.is_there()) return std::optional<MapOrigin>{};
    try {
        return std::optional(read_checked(file));
    } catch (const Error& error) {
        return fail(ExitCode::bad_data,
                    with_remedy(error, "replay the recording again, or move this file away"));
    }
}

std::optional<AppError> fault_of_map(const FilePlace& map, const MapOrigin& origin) {
    const auto described = origin.maps.find(map.filename());
    if (described == origin.maps.end()) return std::nullopt;
    const auto found = crc32_of(map);
    if (found == described->second) return std::nullopt;
    const std::string beside = kMapOriginFile;
    return AppError{ExitCode::bad_data,
                    {.code = ErrorCode::mismatch,
                     .what = "was changed, or belongs to another replay: expected the map that " + beside +
                             " beside it describes, with the CRC-32 " + crc_text(described->second),
                     .value = found ? crc_text(*found) : "none that can be computed",
                     .remedy = "replay " + origin.recording.string() + " again, or move " + beside +
                               " away to evaluate the map without its origin",
                     .file = map.shown()}};
}

}  // namespace octoskin
