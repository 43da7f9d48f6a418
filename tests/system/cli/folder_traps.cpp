#include "tests/system/cli/folder_traps.hpp"

#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <system_error>

namespace octoskin {

namespace fs = std::filesystem;

bool lay(Trap trap, const fs::path& at, const fs::path& twin, const fs::path& victim) {
    std::error_code error;
    fs::remove_all(at, error);
    fs::create_directories(at.parent_path(), error);
    switch (trap) {
        case Trap::link_to_file:
            fs::create_symlink(twin.lexically_relative(at.parent_path()), at, error);
            break;
        case Trap::absolute_link:
            fs::create_symlink(twin, at, error);
            break;
        case Trap::link_to_folder:
            fs::create_symlink(victim, at, error);
            break;
        case Trap::link_to_nothing:
            fs::create_symlink(victim / "new", at, error);
            break;
        case Trap::hard_link:
            fs::create_hard_link(twin, at, error);
            break;
        case Trap::pipe:
            return ::mkfifo(at.c_str(), 0600) == 0;
        case Trap::device:
            return ::mknod(at.c_str(), S_IFCHR | 0600, makedev(1, 5)) == 0;  // /dev/zero
        case Trap::folder:
            fs::create_directory(at, error);
            break;
    }
    return !error;
}

}  // namespace octoskin
