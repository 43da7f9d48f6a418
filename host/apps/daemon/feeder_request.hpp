// The request `camera NAME` of the control socket: its client feeds that camera from then on.
#pragma once

#include <optional>
#include <string>

#include "host/apps/daemon/camera_inputs.hpp"

namespace octoskin {

/// The name in "camera NAME"; "" in "camera" and "camera ". Empty: another request.
[[nodiscard]] std::optional<std::string> fed_camera_of(const std::string& line);

/// Answers a request of this kind, and gives its connection to the camera. False: it is another request, or
/// is refused, and the connection stays the caller's.
[[nodiscard]] bool take_feeder(CameraInputs& cameras, const std::string& line, int connection);

/// The answer to a request that `take_feeder` has refused, a line of JSON without a line feed.
[[nodiscard]] std::string feeder_refusal(const CameraInputs& cameras, const std::string& name);

}  // namespace octoskin
