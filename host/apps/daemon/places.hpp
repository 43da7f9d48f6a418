// Default places of the daemon's sockets and maps.
#pragma once

#include <filesystem>

namespace octoskin {

/// In the service manager's directory for this service, else in the user's, else /run/octoskin.
[[nodiscard]] std::filesystem::path default_control_socket();

/// Beside the control socket.
[[nodiscard]] std::filesystem::path default_joint_socket();

/// Of `octoskin bridge`: in the service manager's directory for the bridge's service, else in the user's,
/// else /run/octoskin-bridge/status.
[[nodiscard]] std::filesystem::path default_bridge_socket();

/// In the service manager's state directory for this service, else in the user's.
[[nodiscard]] std::filesystem::path default_map_folder();

}  // namespace octoskin
