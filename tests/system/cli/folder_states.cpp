#include "tests/system/cli/folder_states.hpp"

#include <sys/stat.h>

#include <sstream>

#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

std::string state_of(const std::filesystem::path& path, Bytes bytes) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0) return "absent";
    std::ostringstream text;
    text << status.st_mode << ' ' << status.st_uid << ' ' << status.st_mtim.tv_sec << '.'
         << status.st_mtim.tv_nsec << ' ';
    if (!S_ISREG(status.st_mode)) return text.str();
    if (bytes == Bytes::compared) {
        text << content(path);
    } else {
        text << status.st_size;
    }
    return text.str();
}

}  // namespace

std::map<std::string, std::string> states_in(const std::filesystem::path& folder, Bytes bytes) {
    std::map<std::string, std::string> states{{".", state_of(folder, bytes)}};
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        states[entry.path().lexically_relative(folder).string()] = state_of(entry.path(), bytes);
    return states;
}

}  // namespace octoskin
