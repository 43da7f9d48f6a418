#include "host/io/openni2/helpers/helper_limits.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <new>

#include "host/io/openni2/helper_process.hpp"

namespace octoskin::openni2 {
namespace {

// The sanitizers reserve terabytes of addresses, which no limit would let them.
#ifdef OCTOSKIN_SANITIZED
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif
constexpr rlim_t kMemoryMax = rlim_t{kHelperMemoryMib} << 20U;

}  // namespace

void limit_this_process(Orphan orphan) {
    std::signal(SIGPIPE, SIG_IGN);
    if (orphan == Orphan::is_killed) ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    const rlimit memory{kMemoryMax, kMemoryMax};
    if (kLimitsMemory) ::setrlimit(RLIMIT_AS, &memory);
    std::set_new_handler([] { ::_exit(kOutOfMemory); });
}

void allow_processor_seconds(unsigned seconds) {
    rusage used{};
    rlimit limit{};
    ::getrusage(RUSAGE_SELF, &used);
    ::getrlimit(RLIMIT_CPU, &limit);
    limit.rlim_cur = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1U + seconds;
    ::setrlimit(RLIMIT_CPU, &limit);
}

int take_standard_output() {
    const int output = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    ::dup2(STDERR_FILENO, STDOUT_FILENO);
    return output;
}

}  // namespace octoskin::openni2
