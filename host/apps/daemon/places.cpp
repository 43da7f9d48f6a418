#include "host/apps/daemon/places.hpp"

#include <cstdlib>

namespace octoskin {
namespace {

namespace fs = std::filesystem;

/// The first directory of a variable that may hold several, as systemd's may; empty if it is not set.
fs::path directory_in(const char* variable) {
    const char* const value = std::getenv(variable);
    if (value == nullptr) return {};
    const std::string text = value;
    return text.substr(0, text.find(':'));
}

}  // namespace

fs::path default_control_socket() {
    constexpr const char* kService = "/run/octoskin/control";
    if (const fs::path own = directory_in("RUNTIME_DIRECTORY"); !own.empty()) return own / "control";
    const fs::path user = directory_in("XDG_RUNTIME_DIR");
    std::error_code error;
    if (user.empty() || fs::exists(kService, error)) return kService;
    return user / "octoskin-control";
}

fs::path default_joint_socket() {
    const fs::path control = default_control_socket();
    const bool is_of_service = control.filename() == "control";
    return control.parent_path() / (is_of_service ? "joints" : "octoskin-joints");
}

fs::path default_bridge_socket() {
    constexpr const char* kService = "/run/octoskin-bridge/status";
    if (const fs::path own = directory_in("RUNTIME_DIRECTORY"); own.filename() == "octoskin-bridge")
        return own / "status";
    const fs::path user = directory_in("XDG_RUNTIME_DIR");
    std::error_code error;
    if (user.empty() || fs::exists(kService, error)) return kService;
    return user / "octoskin-bridge";
}

fs::path default_map_folder() {
    if (const fs::path own = directory_in("STATE_DIRECTORY"); !own.empty()) return own;
    if (const fs::path user = directory_in("XDG_STATE_HOME"); !user.empty()) return user / "octoskin";
    if (const fs::path home = directory_in("HOME"); !home.empty()) return home / ".local/state/octoskin";
    return "/var/lib/octoskin";
}

}  // namespace octoskin
