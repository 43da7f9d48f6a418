// A recording: a directory of regular files that any tool can open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/source_file.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// Beside maps: their provenance (host/apps/playback/map_origin.hpp).
inline constexpr const char* kMapOriginFile = "maps.yaml";
/// In a recording: the default folder of its maps.
inline constexpr const char* kMapsOfRecording = "maps";

/// The places of a recording's files: below a folder that is opened once, without following links there.
struct RecordingPaths {
    /// A named folder for reading; it is opened when one of its files is first needed.
    explicit RecordingPaths(const FilePlace& place) : directory(place.shown()), folder(place) {}
    /// An open folder for reading or, if it was opened so, for writing.
    explicit RecordingPaths(OpenFolder opened) : directory(opened.shown()), folder(std::move(opened)) {}

    [[nodiscard]] FilePlace can_log() const { return file("can.log"); }
    /// Of the camera with this name: depth/NAME.oni; of a rig's only camera, without a name: depth.oni.
    [[nodiscard]] FilePlace depth(std::string_view camera = {}) const {
        return file(depth_name(camera, ".oni"));
    }
    [[nodiscard]] FilePlace depth_epoch(std::string_view camera = {}) const {
        return file(depth_name(camera, ".epoch.yaml"));
    }
    /// The folder of the depth frames of named cameras.
    static constexpr const char* kDepthFolder = "depth";
    /// The names of the cameras with one of both files, sorted; "" for depth.oni. Other names in kDepthFolder
    /// are ignored.
    [[nodiscard]] std::vector<std::string> cameras() const;
    [[nodiscard]] FilePlace rig() const { return file("rig.yaml"); }
    [[nodiscard]] FilePlace robot() const { return file("robot.urdf"); }
    /// In a daemon's recording: the order of the map's updates, the mapping profile, and the map before and
    /// after.
    [[nodiscard]] FilePlace order() const { return file("order.log"); }
    [[nodiscard]] FilePlace mapping() const { return file("mapping.yaml"); }
    [[nodiscard]] FilePlace first_map() const { return file("first.ot"); }
    /// The whole state before the recording, from which the map and everything after it follow.
    [[nodiscard]] FilePlace first_state() const { return file("first.snapshot"); }
    [[nodiscard]] FilePlace last_map() const { return file("last.ot"); }
    /// In a simulation's recording: scenario and world. Neither refers to a file outside the recording.
    [[nodiscard]] FilePlace scenario() const { return file("scenario.yaml"); }
    [[nodiscard]] FilePlace world() const { return file("world.sdf"); }
    [[nodiscard]] FilePlace motion() const { return file("motion.yaml"); }
    /// The existing meshes of that world, by name: mesh_01.stl etc.
    [[nodiscard]] std::vector<FilePlace> meshes() const;
    [[nodiscard]] FilePlace meta() const { return file("meta.yaml"); }

    /// The places of all files that a recording may have.
    [[nodiscard]] std::vector<FilePlace> files() const;

    [[nodiscard]] FilePlace file(const std::string& name) const { return {folder, name}; }

    /// "depth.oni", or "depth/left.oni" of the camera `left`.
    [[nodiscard]] static std::string depth_name(std::string_view camera, std::string_view ending);

    std::filesystem::path directory;  ///< as named by the user: for messages and provenance
    NamedFolder folder;
};

/// Provenance of a recording: for people and for later checks, never for the map.
struct RecordingMeta {
    std::string made_by;                ///< program, version, build
    std::string source;                 ///< "simulation" or "robot"
    SourceFile world;                   ///< the simulated one; empty for a robot
    SourceFile scenario;                ///< the simulated one; empty for a robot
    SourceFile rig;                     ///< the given one; the recording's own contains the seed's shift
    std::optional<std::uint64_t> seed;  ///< of the simulation
    bool is_depth_noise_free = false;
    std::optional<std::uint32_t> scene_crc32 =
        {};  ///< of the scene files in the recording; empty: there are none
    std::uint64_t can_frames = 0;
    std::uint64_t depth_frames = 0;
    double duration_s = 0.0;

    [[nodiscard]] bool is_simulated() const { return source == "simulation"; }
};

[[nodiscard]] Status<Error> write_meta(const RecordingPaths& recording, const RecordingMeta& meta);

/// Reads meta.yaml as strictly as a rig: unknown or repeated keys, values of a wrong type or out of range,
/// anchors and tags are errors with their line.
[[nodiscard]] Result<RecordingMeta, Error> read_meta(const RecordingPaths& recording);

/// That `directory` holds every file a recording must have (docs/reference/recording-folder.md); names the
/// one that is missing, and what to put there. rig.yaml may be missing if another one `is_rig_given`; a
/// recording without a camera has neither depth.oni nor its sidecar, and so with each named camera. The robot
/// is not looked for: the rig names it. Refuses a link, pipe, folder or device in the place of any file that
/// a recording may have, and a recording that a killed process left half moved, with what finishes it. Writes
/// nothing.
[[nodiscard]] Status<Error> check_recording(const RecordingPaths& recording, bool is_rig_given = false);

}  // namespace octoskin
