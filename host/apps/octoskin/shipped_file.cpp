#include "host/apps/octoskin/commands.hpp"

namespace octoskin::app {

std::filesystem::path shipped_file(const std::string& relative) {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    const auto installed = self.parent_path() / "share" / "octoskin" / relative;
    if (std::filesystem::exists(installed, error)) return installed;
    return std::filesystem::path(OCTOSKIN_SHIPPED_DIR) / relative;
}

}  // namespace octoskin::app
