// Writes a recording's files in its own thread.
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
#include "host/errors/error.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/orderlog/order_line.hpp"

namespace octoskin {

/// The data at the start of a recording.
struct RecordingBegin {
    RecordingPaths paths;
    std::string rig;                    ///< the rig file's text; names robot.urdf
    std::string robot;                  ///< the URDF's text
    std::string mapping;                ///< mapping.yaml's text
    orderlog::Header order;             ///< without the checksums of the first map and state
    std::uint32_t placement_crc32 = 0;  ///< as in a SnapshotOrigin
    MapState first;
    std::vector<std::string> cameras = {};  ///< the names of the rig's, in its order
};

/// The data at its end.
struct RecordingEnd {
    orderlog::Trailer order;  ///< without the checksum of the last map
    std::string remarks;      ///< lines before the trailer, each starting with '#'
    RecordingMeta meta;
    std::optional<FusedMap> last_map;  ///< empty: there was no memory for it, and the recording fails
};

class RecordingWriter {
  public:
    /// Bytes of each text that may wait: seconds of a full bus.
    static constexpr std::size_t kTextMax = std::size_t{8} << 20U;
    /// Saves a map under that name; returns the file's CRC-32.
    using MapWriter = std::function<Result<std::uint32_t, Error>(const FusedMap& map, const FilePlace& file)>;

    /// Throws std::system_error if there is no thread left.
    explicit RecordingWriter(RecordingBegin begin, MapWriter map_writer = save_map);
    /// Stops writing at any point, unless it has ended. Takes at most 0.2 s: a write that hangs is left
    /// behind, and that is logged.
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    // None of these waits. False: there was no room, or recording failed, and the input is not recorded.
    [[nodiscard]] bool add_can(const std::string& line);
    [[nodiscard]] bool add_order(const std::string& line);
    [[nodiscard]] bool add_depth(const DepthFrame& frame);
    void finish(RecordingEnd end);

    [[nodiscard]] bool has_ended() const;
    /// The error; empty: none so far.
    [[nodiscard]] std::optional<Error> error() const;
    /// When the write, or the request to the folder, in progress began; empty: none is.
    [[nodiscard]] std::optional<HostTime> writing_since() const;
    /// Why the folder was refused, so that nothing is written; empty if it was accepted, or if the disk has
    /// not answered within `patience`.
    [[nodiscard]] std::optional<Error> refusal(Nanoseconds patience);
    /// Waits for the end, after `finish`; false if `patience` was too short.
    [[nodiscard]] bool wait(Nanoseconds patience);

  private:
    class Work;
    std::shared_ptr<Work> work_;
    LeavableThread thread_;
};

}  // namespace octoskin
