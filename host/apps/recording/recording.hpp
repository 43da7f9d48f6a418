// A recording: a directory of ordinary files that any tool can open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/source_file.hpp"

namespace octoskin {

/// Beside maps: what they were made from (host/apps/playback/map_origin.hpp).
inline constexpr const char* kMapOriginFile = "maps.yaml";

/// Where the files of a recording are.
struct RecordingPaths {
    explicit RecordingPaths(std::filesystem::path directory_in) : directory(std::move(directory_in)) {}

    [[nodiscard]] std::filesystem::path can_log() const { return directory / "can.log"; }
    [[nodiscard]] std::filesystem::path depth() const { return directory / "depth.oni"; }
    [[nodiscard]] std::filesystem::path depth_epoch() const { return directory / "depth.epoch.yaml"; }
    [[nodiscard]] std::filesystem::path rig() const { return directory / "rig.yaml"; }
    [[nodiscard]] std::filesystem::path robot() const { return directory / "robot.urdf"; }
    /// Of a recording that the daemon made: the order in which its map was made, how measurements became
    /// voxels, and its map before and after.
    [[nodiscard]] std::filesystem::path order() const { return directory / "order.log"; }
    [[nodiscard]] std::filesystem::path mapping() const { return directory / "mapping.yaml"; }
    [[nodiscard]] std::filesystem::path first_map() const { return directory / "first.ot"; }
    [[nodiscard]] std::filesystem::path last_map() const { return directory / "last.ot"; }
    [[nodiscard]] std::filesystem::path meta() const { return directory / "meta.yaml"; }

    std::filesystem::path directory;
};

/// Where a recording comes from: for people and for provenance, never for the map.
struct RecordingMeta {
    std::string made_by;                ///< program, version, build
    std::string source;                 ///< "simulation" or "robot"
    SourceFile world;                   ///< that was simulated; empty for a robot
    SourceFile scenario;                ///< that was simulated; empty for a robot
    SourceFile rig;                     ///< as it was given: the recording's own has the seed's shift
    std::optional<std::uint64_t> seed;  ///< of the simulation
    bool is_depth_noise_free = false;
    std::uint64_t can_frames = 0;
    std::uint64_t depth_frames = 0;
    double duration_s = 0.0;

    [[nodiscard]] bool is_simulated() const { return source == "simulation"; }
};

struct RecordingError {
    std::filesystem::path file;
    std::string what;
    int line = 0;     ///< 1-based; 0 if it concerns the whole file
    std::string key;  ///< of meta.yaml; empty if it is about none
    [[nodiscard]] std::string message() const;
};

[[nodiscard]] Status<RecordingError> write_meta(const RecordingPaths& recording, const RecordingMeta& meta);

/// Reads meta.yaml, as strictly as a rig: unknown or repeated keys, values of another type or out of range,
/// anchors and tags are refused, with their line.
[[nodiscard]] Result<RecordingMeta, RecordingError> read_meta(const RecordingPaths& recording);

/// That `directory` holds every file a recording must have (docs/recording.md); names the one that is
/// missing, and what to put there. rig.yaml may be missing if another one `is_rig_given`; a recording without
/// a camera has neither depth.oni nor its sidecar. The robot is not looked for: the rig names it.
[[nodiscard]] Status<RecordingError> check_recording(const RecordingPaths& recording,
                                                     bool is_rig_given = false);

}  // namespace octoskin
