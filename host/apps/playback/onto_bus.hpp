// A recording's frames onto a CAN interface, as far apart as they were.
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
    std::string interface;  ///< of the log, whose frames were sent: its first one
    std::uint64_t sent = 0;
    std::uint64_t error_frames = 0;     ///< what an adapter said of the bus: nothing that can be sent
    std::uint64_t other_interface = 0;  ///< frames of the log's other interfaces
    std::uint64_t lines_refused = 0;    ///< lines that are no frames
    std::uint64_t waited = 0;           ///< frames for which there was no room at once
};

/// Told before each frame: what was sent so far, and how long after the log's first frame this one was
/// received.
using OntoReport = std::function<void(const OntoBus& so_far, Nanoseconds into_log)>;

/// Sends every frame of `can_log`, classical as classical and FD as FD, at the pace given. Errors: a log that
/// cannot be read, or has no frame; an interface that fails, or that has had no room for 2 s.
[[nodiscard]] Result<OntoBus, AppError> play_onto(const FilePlace& can_log, socketcan::CanSocket& socket,
                                                  Pace pace, const OntoReport& report = {});

}  // namespace octoskin
