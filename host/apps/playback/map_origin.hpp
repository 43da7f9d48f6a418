// What the maps of a folder were made from, kept beside them: a map says nothing of it itself.
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
    std::filesystem::path recording;            ///< its directory, absolute
    std::uint32_t recording_crc32 = 0;          ///< see crc32_of_recording()
    std::filesystem::path rig;                  ///< absolute
    std::uint32_t rig_hash = 0;                 ///< of the rig that was used, with T_map_base
    std::filesystem::path robot;                ///< absolute
    std::optional<std::uint32_t> robot_crc32;   ///< of its bytes
    std::string configuration;                  ///< name of the mapping, and
    std::string mapping;                        ///< all that it says: mapping_text()
    std::map<std::string, std::uint32_t> maps;  ///< file names and the CRC-32 of their bytes
};

/// depth, proximity and fused, each as .ot, .bt and .ply: all names that a folder's maps may have.
[[nodiscard]] std::vector<std::string> map_file_names();

/// CRC-32 of what a recording measured: can.log, and depth.oni with its sidecar, order.log
/// first.ot and first.snapshot if they are there. Rig and
/// robot have their own. Empty if one cannot be read.
[[nodiscard]] std::optional<std::uint32_t> crc32_of_recording(const RecordingPaths& recording,
                                                              const BytesReport& report = {});

[[nodiscard]] Status<AppError> write_map_origin(const FilePlace& file, const MapOrigin& origin);

/// That of the maps in `folder`; empty if nothing says so. Read as strictly as a rig (bad_data).
[[nodiscard]] Result<std::optional<MapOrigin>, AppError> read_map_origin(const NamedFolder& folder);

/// Why `map` cannot be what `origin` describes (bad_data): its bytes are others. Empty, too, if the origin
/// does not speak of it.
[[nodiscard]] std::optional<AppError> fault_of_map(const FilePlace& map, const MapOrigin& origin);

}  // namespace octoskin
