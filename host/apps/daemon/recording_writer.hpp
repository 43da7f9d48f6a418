// A recording's files, written by a thread while the daemon goes on.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/result.hpp"
#include "host/apps/daemon/depth_recorder.hpp"
#include "host/apps/daemon/growing_file.hpp"
#include "host/apps/daemon/text_queue.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/io/orderlog/order_line.hpp"

namespace octoskin {

/// What a recording begins with.
struct RecordingBegin {
    RecordingPaths paths;
    std::string rig;         ///< the rig file's text; names robot.urdf
    std::string robot;       ///< the URDF's text
    std::string mapping;     ///< mapping.yaml's text
    orderlog::Header order;  ///< but for the checksum of the first map
    FusedMap first_map;
};

/// What it ends with.
struct RecordingEnd {
    orderlog::Trailer order;  ///< but for the checksum of the last map
    std::string remarks;      ///< lines before the trailer, each begun with '#'
    RecordingMeta meta;
    FusedMap last_map;
};

class RecordingWriter {
  public:
    /// What may wait of each text: seconds of a full bus.
    static constexpr std::size_t kTextMax = std::size_t{8} << 20U;

    explicit RecordingWriter(RecordingBegin begin);
    /// Stops writing, wherever it is, unless it has ended.
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    // None of these waits. False: there was no room, or recording failed, and it is not recorded.
    [[nodiscard]] bool add_can(const std::string& line) { return can_.add(line); }
    [[nodiscard]] bool add_order(const std::string& line) { return order_.add(line); }
    [[nodiscard]] bool add_depth(const DepthFrame& frame) { return depth_.add(frame); }
    void finish(RecordingEnd end);

    [[nodiscard]] bool has_ended() const;
    /// What went wrong, for a person; empty: nothing so far.
    [[nodiscard]] std::string error() const;
    /// Waits for the end, after `finish`; false if `patience` was too short.
    [[nodiscard]] bool wait(Nanoseconds patience);

  private:
    using Step = Status<std::string>;
    void work();
    [[nodiscard]] Step record();
    [[nodiscard]] Step begin();
    [[nodiscard]] Step write_waiting();
    /// True once `finish` or the destructor asks for the end.
    [[nodiscard]] bool rest();
    [[nodiscard]] Step end(RecordingEnd end);

    RecordingBegin begin_;
    TextQueue can_{kTextMax};
    TextQueue order_{kTextMax};
    DepthRecorder depth_;
    GrowingFile can_file_;
    GrowingFile order_file_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<RecordingEnd> end_;
    bool is_dropped_ = false;
    bool has_ended_ = false;
    std::string error_;
    std::thread thread_;
};

}  // namespace octoskin
