// A recording's files, written by a thread while the daemon goes on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/map_state.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/orderlog/order_line.hpp"

namespace octoskin {

/// What a recording begins with.
struct RecordingBegin {
    RecordingPaths paths;
    std::string rig;                    ///< the rig file's text; names robot.urdf
    std::string robot;                  ///< the URDF's text
    std::string mapping;                ///< mapping.yaml's text
    orderlog::Header order;             ///< but for the checksums of the first map and state
    std::uint32_t placement_crc32 = 0;  ///< as in a SnapshotOrigin
    MapState first;
};

/// What it ends with.
struct RecordingEnd {
    orderlog::Trailer order;  ///< but for the checksum of the last map
    std::string remarks;      ///< lines before the trailer, each begun with '#'
    RecordingMeta meta;
    std::optional<FusedMap> last_map;  ///< empty: there was no memory for it, so that the recording fails
};

class RecordingWriter {
  public:
    /// What may wait of each text: seconds of a full bus.
    static constexpr std::size_t kTextMax = std::size_t{8} << 20U;
    /// Saves a map under that name; gives the file's CRC-32.
    using MapWriter =
        std::function<Result<std::uint32_t, MapFileError>(const FusedMap& map, const FilePlace& file)>;

    /// Throws std::system_error if there is no thread to be had.
    explicit RecordingWriter(RecordingBegin begin, MapWriter map_writer = save_map);
    /// Stops writing, wherever it is, unless it has ended. Within 0.2 s: a write that hangs is left behind,
    /// and the log says so.
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    // None of these waits. False: there was no room, or recording failed, and it is not recorded.
    [[nodiscard]] bool add_can(const std::string& line);
    [[nodiscard]] bool add_order(const std::string& line);
    [[nodiscard]] bool add_depth(const DepthFrame& frame);
    void finish(RecordingEnd end);

    [[nodiscard]] bool has_ended() const;
    /// What went wrong, for a person; empty: nothing so far.
    [[nodiscard]] std::string error() const;
    /// When what is being written, or asked of the folder, was begun; empty: nothing is.
    [[nodiscard]] std::optional<HostTime> writing_since() const;
    /// Why the folder was not taken, and nothing written; empty if it was, or if the disk has not told within
    /// `patience`.
    [[nodiscard]] std::string refusal(Nanoseconds patience);
    /// Waits for the end, after `finish`; false if `patience` was too short.
    [[nodiscard]] bool wait(Nanoseconds patience);

  private:
    class Work;
    std::shared_ptr<Work> work_;
    LeavableThread thread_;
};

}  // namespace octoskin
