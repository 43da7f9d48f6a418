// Sends a recording's frames to a CAN interface with the original time differences.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/playback/pace.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/socketcan/can_socket.hpp"

namespace octoskin {

struct OntoBus {
    std::string interface;  ///< interface of the log whose frames were sent: its first one
    std::uint64_t sent = 0;
    std::uint64_t error_frames = 0;     ///< error frames of the adapter; they cannot be sent
    std::uint64_t other_interface = 0;  ///< frames of the log's other interfaces
    std::uint64_t lines_refused = 0;    ///< lines that are not frames
    std::uint64_t waited = 0;           ///< frames that had to wait for room in the socket
};

/// Called before each frame: the counts so far, and the time between the log's first frame and this one.
using OntoReport = std::function<void(const OntoBus& so_far, Nanoseconds into_log)>;

/// Sends every frame of `can_log` at the given pace, classical frames as classical ones and FD frames as FD.
/// Errors: a log that cannot be read or has no frame; an interface that fails, or has no room for 2 s.
[[nodiscard]] Result<OntoBus, AppError> play_onto(const FilePlace& can_log, socketcan::CanSocket& socket,
                                                  Pace pace, const OntoReport& report = {});

}  // namespace octoskin
