#include "host/io/helper_limits/privileges.hpp"

#include <linux/capability.h>
#include <linux/landlock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace octoskin {
namespace {

/// Enters a Landlock domain in which no file may be changed: a process cannot inspect processes outside of
/// its domain.
void enter_own_domain() {
    landlock_ruleset_attr attributes{};
    attributes.handled_access_fs =
        LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
        LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_DIR |
        LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
        LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;
    const auto ruleset = static_cast<int>(
        ::syscall(SYS_landlock_create_ruleset, &attributes, sizeof(attributes.handled_access_fs), 0));
    if (ruleset < 0) return;
    ::syscall(SYS_landlock_restrict_self, ruleset, 0);
    ::close(ruleset);
}

/// Of root's rights, keeps only the one to read all files.
void keep_reading_alone() {
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> sets{};
    if (::syscall(SYS_capget, &header, sets.data()) != 0) return;
    for (std::size_t i = 0; i < sets.size(); ++i) {
        const std::uint32_t kept = i == 0 ? 1U << CAP_DAC_READ_SEARCH : 0U;
        sets[i] = {sets[i].effective & kept, sets[i].permitted & kept, 0};
    }
    ::syscall(SYS_capset, &header, sets.data());
}

}  // namespace

void give_up_privileges() {
    enter_own_domain();
    keep_reading_alone();
}

}  // namespace octoskin
