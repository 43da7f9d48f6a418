// Whether a process can be confined here (host/io/helper_limits/confinement.hpp).
#pragma once

#include <linux/seccomp.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>

namespace octoskin::testing_support {

/// Why a test of the confinement cannot run; null: it can.
inline const char* why_no_filters() {
#ifdef OCTOSKIN_SANITIZED
    return "sanitizers ask for more";
#endif
    const std::uint32_t action = SECCOMP_RET_KILL_PROCESS;  // an emulator has no such filter
    return ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0 ? nullptr : "no filters here";
}

}  // namespace octoskin::testing_support
