#include "host/apps/command_line/shipped_file.hpp"

namespace octoskin::app {

std::filesystem::path shipped_file(const std::string& relative) {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    const auto data = self.parent_path() / "share" / "octoskin";
    // In a build, the folders in share/octoskin are links to the sources. A relative link starts at its own
    // folder, not at the working directory: it is resolved here.
    const auto place = std::filesystem::weakly_canonical(data / relative, error);
    return error ? data / relative : place;
}

}  // namespace octoskin::app
