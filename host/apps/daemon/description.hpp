// What a program beside the daemon needs to know of the rig and the robot: the answer to `describe`.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin {

/// Frames of the robot, joint sources, range sensors and cameras; every key:
/// docs/reference/control-socket.md. `reads_cameras` false: the cameras are left out. `reloads`: as
/// `reloads.count` of the status, which so tells when this answer is out of date.
[[nodiscard]] nlohmann::ordered_json description_json(const HostSetup& setup, bool reads_cameras,
                                                      std::uint64_t reloads);

}  // namespace octoskin
