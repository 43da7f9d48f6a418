// Provenance of the maps of a folder, in a file beside them: a map file does not contain it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/apps/recording/source_file.hpp"

namespace octoskin {

struct MapOrigin {
    std::string made_by;                        ///< program, version, build
    std::filesystem::path recording;            ///< directory, absolute path
    std::uint32_t recording_crc32 = 0;          ///< see crc32_of_recording()
    std::filesystem::path rig;                  ///< absolute
    std::uint32_t rig_hash = 0;                 ///< hash of the rig that was used, with T_map_base
    std::filesystem::path robot;                ///< absolute
    std::optional<std::uint32_t> robot_crc32;   ///< of the file's bytes
    std::string configuration;                  ///< name of the mapping profile
    std::string mapping;                        ///< its whole text: mapping_text()
    std::map<std::string, std::uint32_t> maps;  ///< file names and the CRC-32 of their bytes
};

/// All map file names of a folder: depth, proximity and fused, each as .ot, .bt and .ply.
[[nodiscard]] std::vector<std::string> map_file_names();

/// CRC-32 of a recording's measurements: can.log, and if they exist the depth frames of each camera, in the
/// order of the cameras' names, with their sidecar, order.log, first.ot and first.snapshot. Rig and robot
/// have checksums of their own. Empty if a file cannot be read.
[[nodiscard]] std::optional<std::uint32_t> crc32_of_recording(const RecordingPaths& recording,
                                                              const BytesReport& report = {});

[[nodiscard]] Status<AppError> write_map_origin(const FilePlace& file, const MapOrigin& origin);

/// The origin of the maps in `folder`; empty if there is no such file. Parsed as strictly as a rig
/// (bad_data).
[[nodiscard]] Result<std::optional<MapOrigin>, AppError> read_map_origin(const NamedFolder& folder);

/// Error (bad_data) if the bytes of `map` are not those that `origin` describes. Empty if they are, or if
/// `origin` does not contain this map.
[[nodiscard]] std::optional<AppError> fault_of_map(const FilePlace& map, const MapOrigin& origin);

}  // namespace octoskin
