#include "host/apps/command_line/shipped_file.hpp"

namespace octoskin::app {

std::filesystem::path shipped_file(const std::string& relative) {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    const auto data = self.parent_path() / "share" / "octoskin";
    // Beside the folder of programs of a build, a link that leads to the sources. Whatever a link leads
    // through, it begins where it lies, not in the working directory.
    const auto place = std::filesystem::canonical(data, error);
    return (error ? data : place) / relative;
}

}  // namespace octoskin::app
