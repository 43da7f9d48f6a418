#include "host/apps/recording/recording.hpp"

#include <yaml-cpp/yaml.h>

#include <exception>
#include <fstream>
#include <set>

namespace octoskin {
namespace {

constexpr const char* kSchema = "octoskin-recording/1";

Unexpected<RecordingError> failure(const std::filesystem::path& file, std::string what) {
    return unexpected(RecordingError{file, std::move(what)});
}

Status<RecordingError> check_keys(const std::filesystem::path& file, const YAML::Node& root) {
    static const std::set<std::string> known{
        "schema", "made_by",    "source",     "world",        "scenario",
        "seed",   "duration_s", "can_frames", "depth_frames", "is_depth_noise_free"};
    for (const auto& entry : root) {
        const auto key = entry.first.as<std::string>();
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
    out << YAML::Key << "world" << YAML::Value << meta.world;
    out << YAML::Key << "scenario" << YAML::Value << meta.scenario;
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
    if (!std::filesystem::is_regular_file(path, error))
        return failure(path, "no such file; a recording must have it");
    try {
        const YAML::Node root = YAML::LoadFile(path.string());
        if (!root.IsMap() || root["schema"].as<std::string>("") != kSchema) {
            return failure(path, std::string("expected 'schema: ") + kSchema + "'");
        }
        if (const auto checked = check_keys(path, root); !checked) return unexpected(checked.error());
        RecordingMeta meta;
        meta.made_by = root["made_by"].as<std::string>("");
        meta.source = root["source"].as<std::string>("");
        meta.world = root["world"].as<std::string>("");
        meta.scenario = root["scenario"].as<std::string>("");
        if (root["seed"]) meta.seed = root["seed"].as<std::uint64_t>();
        meta.is_depth_noise_free = root["is_depth_noise_free"].as<bool>(false);
        meta.can_frames = root["can_frames"].as<std::uint64_t>(0);
        meta.depth_frames = root["depth_frames"].as<std::uint64_t>(0);
        meta.duration_s = root["duration_s"].as<double>(0.0);
        return meta;
    } catch (const std::exception& broken) {  // yaml-cpp's own, and the stream's
        return failure(path, broken.what());
    }
}

Status<RecordingError> check_recording(const RecordingPaths& recording) {
    std::error_code error;
    if (!std::filesystem::is_directory(recording.directory)) {
        return failure(recording.directory,
                       "no such directory; `octoskin simulate` and `./demo` make recordings");
    }
    for (const auto& file : {recording.can_log(), recording.rig(), recording.robot(), recording.meta()}) {
        if (!std::filesystem::is_regular_file(file, error))
            return failure(file, "no such file; a recording must have it");
    }
    if (std::filesystem::exists(recording.depth()) != std::filesystem::exists(recording.depth_epoch())) {
        return failure(recording.directory, "depth.oni and depth.epoch.yaml must both be there, or neither");
    }
    return Done{};
}

}  // namespace octoskin
