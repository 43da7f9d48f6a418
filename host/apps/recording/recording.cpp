#include "host/apps/recording/recording.hpp"

#include <yaml-cpp/yaml.h>

#include <exception>
#include <fstream>
#include <set>

namespace octoskin {
namespace {

constexpr const char* kSchema = "octoskin-recording/1";
constexpr const char* kMetaMissing =
    "no such file; the least that it can be is two lines, 'schema: octoskin-recording/1' and 'source: robot'";

Unexpected<RecordingError> failure(const std::filesystem::path& file, std::string what) {
    return unexpected(RecordingError{file, std::move(what)});
}

void write_source(YAML::Emitter& out, const std::string& key, const SourceFile& source) {
    if (source.file.empty()) return;
    out << YAML::Key << key << YAML::Value << source.file.string();
    if (source.crc32) out << YAML::Key << key + "_crc32" << YAML::Value << crc_text(*source.crc32);
}

SourceFile read_source(const YAML::Node& root, const std::string& key) {
    SourceFile source{root[key].as<std::string>(""), std::nullopt};
    if (const YAML::Node crc = root[key + "_crc32"]) source.crc32 = crc.as<std::uint32_t>();
    return source;
}

/// An absent key has its default; a value of another type throws.
template <typename T>
T value_or(const YAML::Node& root, const char* key, T otherwise) {
    const YAML::Node value = root[key];
    return value ? value.as<T>() : otherwise;
}

Status<RecordingError> check_keys(const std::filesystem::path& file, const YAML::Node& root) {
    static const std::set<std::string> known{
        "schema", "made_by",   "source", "world",      "world_crc32", "scenario",     "scenario_crc32",
        "rig",    "rig_crc32", "seed",   "duration_s", "can_frames",  "depth_frames", "is_depth_noise_free"};
    std::set<std::string> seen;
    for (const auto& entry : root) {
        const auto key = entry.first.as<std::string>();
        if (!seen.insert(key).second) {
            return failure(file, "line " + std::to_string(entry.first.Mark().line + 1) + ": key '" + key +
                                     "' stands there twice");
        }
        if (!known.contains(key)) {
            return failure(
                file, "line " + std::to_string(entry.first.Mark().line + 1) + ": unknown key '" + key + "'");
        }
    }
    return Done{};
}

}  // namespace

Status<RecordingError> write_meta(const RecordingPaths& recording, const RecordingMeta& meta) {
    YAML::Emitter out;
    out << YAML::BeginMap;
    out << YAML::Key << "schema" << YAML::Value << kSchema;
    out << YAML::Key << "made_by" << YAML::Value << meta.made_by;
    out << YAML::Key << "source" << YAML::Value << meta.source;
    write_source(out, "world", meta.world);
    write_source(out, "scenario", meta.scenario);
    write_source(out, "rig", meta.rig);
    if (meta.seed) out << YAML::Key << "seed" << YAML::Value << *meta.seed;
    out << YAML::Key << "is_depth_noise_free" << YAML::Value << meta.is_depth_noise_free;
    out << YAML::Key << "can_frames" << YAML::Value << meta.can_frames;
    out << YAML::Key << "depth_frames" << YAML::Value << meta.depth_frames;
    out << YAML::Key << "duration_s" << YAML::Value << meta.duration_s;
    out << YAML::EndMap;
    std::ofstream file(recording.meta());
    file << out.c_str() << '\n';
    file.close();
    if (!file) return failure(recording.meta(), "cannot write; is the disk full, is the folder yours?");
    return Done{};
}

Result<RecordingMeta, RecordingError> read_meta(const RecordingPaths& recording) {
    const auto path = recording.meta();
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return failure(path, kMetaMissing);
    try {
        const YAML::Node root = YAML::LoadFile(path.string());
        if (!root.IsMap() || root["schema"].as<std::string>("") != kSchema) {
            return failure(path, std::string("expected 'schema: ") + kSchema + "'");
        }
        if (const auto checked = check_keys(path, root); !checked) return unexpected(checked.error());
        RecordingMeta meta;
        meta.made_by = value_or<std::string>(root, "made_by", "");
        meta.source = value_or<std::string>(root, "source", "");
        meta.world = read_source(root, "world");
        meta.scenario = read_source(root, "scenario");
        meta.rig = read_source(root, "rig");
        if (root["seed"]) meta.seed = root["seed"].as<std::uint64_t>();
        meta.is_depth_noise_free = value_or(root, "is_depth_noise_free", false);
        meta.can_frames = value_or<std::uint64_t>(root, "can_frames", 0);
        meta.depth_frames = value_or<std::uint64_t>(root, "depth_frames", 0);
        meta.duration_s = value_or(root, "duration_s", 0.0);
        return meta;
    } catch (const std::exception& broken) {  // yaml-cpp's own, and the stream's
        return failure(path, broken.what());
    }
}

Status<RecordingError> check_recording(const RecordingPaths& recording, bool is_rig_given) {
    std::error_code error;
    if (std::filesystem::is_regular_file(recording.directory, error)) {
        return failure(recording.directory,
                       "is a file; give the recording's directory, " +
                           std::filesystem::absolute(recording.directory).parent_path().string());
    }
    if (!std::filesystem::is_directory(recording.directory, error)) {
        return failure(recording.directory,
                       "no such directory; `octoskin simulate` and `./demo` make recordings");
    }
    const std::pair<std::filesystem::path, const char*> needed[] = {
        {recording.can_log(), "no such file; it is what `candump -L` writes"},
        {recording.rig(), "no such file; put the rig there, or give --rig"},
        {recording.meta(), kMetaMissing}};
    for (const auto& [file, what] : needed) {
        if (is_rig_given && file == recording.rig()) continue;
        if (!std::filesystem::is_regular_file(file, error)) return failure(file, what);
    }
    if (std::filesystem::exists(recording.depth(), error) !=
        std::filesystem::exists(recording.depth_epoch(), error)) {
        return failure(recording.directory, "depth.oni and depth.epoch.yaml must both be there, or neither");
    }
    return Done{};
}

}  // namespace octoskin
