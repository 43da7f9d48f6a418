#include "host/io/helper_limits/helper_limits.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <new>

namespace octoskin {
namespace {

// Sanitizers reserve terabytes of address space, which a limit would prevent.
#ifdef OCTOSKIN_SANITIZED
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

int exit_without_memory = 0;  // global, because a new-handler has no argument

void limit(int resource, rlim_t most) {
    const rlimit both{most, most};
    ::setrlimit(resource, &both);
}

}  // namespace

void limit_this_process(const HelperLimits& limits) {
    std::signal(SIGPIPE, SIG_IGN);
    if (limits.orphan == Orphan::is_killed) ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    limit(RLIMIT_CORE, 0);
    if (kLimitsMemory) limit(RLIMIT_AS, rlim_t{limits.memory_mib} << 20U);
    exit_without_memory = limits.exit_without_memory;
    std::set_new_handler([] { ::_exit(exit_without_memory); });
}

void limit_processor_seconds(std::uint64_t seconds) {
    const rlimit processor{seconds, seconds + 1};
    ::setrlimit(RLIMIT_CPU, &processor);
}

// The hard limit is one second above the soft one: the signal of the soft one shows the reason.
void bound_processor_seconds(std::uint64_t seconds) {
    rlimit limit{};
    ::getrlimit(RLIMIT_CPU, &limit);
    limit.rlim_max = std::min<rlim_t>(limit.rlim_max, seconds);
    limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max - 1);
    ::setrlimit(RLIMIT_CPU, &limit);
}

void allow_processor_seconds(unsigned seconds) {
    rusage used{};
    rlimit limit{};
    ::getrusage(RUSAGE_SELF, &used);
    ::getrlimit(RLIMIT_CPU, &limit);
    limit.rlim_cur = std::min(
        limit.rlim_max - 1, static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1U + seconds);
    ::setrlimit(RLIMIT_CPU, &limit);
}

void limit_file_size(std::uint64_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    limit(RLIMIT_FSIZE, bytes);
}

int take_standard_output() {
    const int output = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    ::dup2(STDERR_FILENO, STDOUT_FILENO);
    return output;
}

}  // namespace octoskin
