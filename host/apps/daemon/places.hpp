// Where the daemon and those who ask it meet, if nobody says otherwise.
#pragma once

#include <filesystem>

namespace octoskin {

/// Under the service manager's directory for this service, else the user's, else /run/octoskin.
[[nodiscard]] std::filesystem::path default_control_socket();

/// Beside the control socket.
[[nodiscard]] std::filesystem::path default_joint_socket();

/// Under the service manager's state directory for this service, else the user's.
[[nodiscard]] std::filesystem::path default_map_folder();

}  // namespace octoskin
