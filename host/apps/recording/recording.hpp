// A recording: a directory of ordinary files that any tool can open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/source_file.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// Beside maps: what they were made from (host/apps/playback/map_origin.hpp).
inline constexpr const char* kMapOriginFile = "maps.yaml";
/// In a recording: where its maps go if nothing else is said.
inline constexpr const char* kMapsOfRecording = "maps";

/// Where the files of a recording are: below a folder that is opened once, and behind no link there.
struct RecordingPaths {
    /// A folder that was named, to read from; opened when a file of it is first needed.
    explicit RecordingPaths(const FilePlace& place) : directory(place.shown()), folder(place) {}
    /// An open one, to read from or, if it was opened so, to write to.
    explicit RecordingPaths(OpenFolder opened) : directory(opened.shown()), folder(std::move(opened)) {}

    [[nodiscard]] FilePlace can_log() const { return file("can.log"); }
    [[nodiscard]] FilePlace depth() const { return file("depth.oni"); }
    [[nodiscard]] FilePlace depth_epoch() const { return file("depth.epoch.yaml"); }
    [[nodiscard]] FilePlace rig() const { return file("rig.yaml"); }
    [[nodiscard]] FilePlace robot() const { return file("robot.urdf"); }
    /// Of a recording that the daemon made: the order in which its map was made, how measurements became
    /// voxels, and its map before and after.
    [[nodiscard]] FilePlace order() const { return file("order.log"); }
    [[nodiscard]] FilePlace mapping() const { return file("mapping.yaml"); }
    [[nodiscard]] FilePlace first_map() const { return file("first.ot"); }
    /// All that the map and what comes after it follow from, before.
    [[nodiscard]] FilePlace first_state() const { return file("first.snapshot"); }
    [[nodiscard]] FilePlace last_map() const { return file("last.ot"); }
    /// Of a simulation: what it happened in. Neither refers to a file outside of the recording.
    [[nodiscard]] FilePlace scenario() const { return file("scenario.yaml"); }
    [[nodiscard]] FilePlace world() const { return file("world.sdf"); }
    [[nodiscard]] FilePlace motion() const { return file("motion.yaml"); }
    /// Of that world, those that are there, by name: mesh_01.stl and the like.
    [[nodiscard]] std::vector<FilePlace> meshes() const;
    [[nodiscard]] FilePlace meta() const { return file("meta.yaml"); }

    /// In the place of each file that a recording may have.
    [[nodiscard]] std::vector<FilePlace> files() const;

    [[nodiscard]] FilePlace file(const std::string& name) const { return {folder, name}; }

    std::filesystem::path directory;  ///< as it was named: for messages and for provenance
    NamedFolder folder;
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
    std::optional<std::uint32_t> scene_crc32 = {};  ///< of the scene's files in it; empty: it has none
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
/// a camera has neither depth.oni nor its sidecar. The robot is not looked for: the rig names it. Refuses a
/// link, pipe, folder or device in the place of any file that a recording may have, and a recording that a
/// killed process left half moved, with what finishes it. Writes nothing.
[[nodiscard]] Status<RecordingError> check_recording(const RecordingPaths& recording,
                                                     bool is_rig_given = false);

}  // namespace octoskin
