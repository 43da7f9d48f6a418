#include "host/io/helper_limits/confinement.hpp"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <span>
#include <vector>

#include "host/io/helper_limits/privileges.hpp"

namespace octoskin {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kArchitecture = 0;
#endif

// Sanitizers read /proc, start a program for their reports and stop the other threads for that.
#ifdef OCTOSKIN_SANITIZED
constexpr bool kConfines = false;
#else
constexpr bool kConfines = kArchitecture != 0;
#endif

/// Marks the system calls of x32, the 32-bit variant of x86-64, which have the same numbers.
constexpr std::uint32_t kOtherCalls = 0x4000'0000U;

/// One half of an argument; only the bits in `mask` are compared.
struct Wanted {
    std::size_t offset;
    std::uint32_t mask;
    std::uint32_t value;
};
constexpr Wanted low_half(std::size_t argument, std::uint32_t value, std::uint32_t mask = ~0U) {
    return {offsetof(seccomp_data, args) + 8 * argument, mask,
            value};  // both architectures are little-endian
}
constexpr Wanted high_half(std::size_t argument, std::uint32_t value) {
    return {offsetof(seccomp_data, args) + 8 * argument + 4, ~0U, value};
}

class Filter {
  public:
    Filter() {
        load(offsetof(seccomp_data, arch));
        add(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
        answer(SECCOMP_RET_KILL_PROCESS);
        load(offsetof(seccomp_data, nr));
        add(BPF_JMP | BPF_JGE | BPF_K, kOtherCalls, 0, 1);
        answer(SECCOMP_RET_KILL_PROCESS);
    }
    void allow(std::initializer_list<long> calls) {
        for (const long call : calls) rule(call, SECCOMP_RET_ALLOW, {});
    }
    /// Allows the call if all its arguments are as wanted.
    void allow(long call, std::initializer_list<Wanted> wanted) { rule(call, SECCOMP_RET_ALLOW, wanted); }
    /// As on a kernel without this call. Used for calls whose arguments are in memory, where a filter cannot
    /// see them, and for which the library or octoskin has an older alternative.
    void lack(long call) { rule(call, SECCOMP_RET_ERRNO | ENOSYS, {}); }

    /// Returns 0, or the error number.
    [[nodiscard]] int install() {
        answer(SECCOMP_RET_KILL_PROCESS);
        const sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
        const long result =
            ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program);
        if (result > 0) return EBUSY;  // a thread has a different filter
        return result == 0 ? 0 : errno;
    }

  private:
    /// Appended after the load of the call number; each rule loads it again at its end.
    void rule(long call, std::uint32_t result, std::span<const Wanted> wanted) {
        const std::size_t length = 1 + 3 * wanted.size();
        std::size_t left = length;  // distance to the end of the rule, for when it does not match
        add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, left + (wanted.empty() ? 0 : 1));
        for (const Wanted& one : wanted) {
            left -= 3;
            load(one.offset);
            add(BPF_ALU | BPF_AND | BPF_K, one.mask);
            add(BPF_JMP | BPF_JEQ | BPF_K, one.value, 0, left);
        }
        answer(result);
        if (!wanted.empty()) load(offsetof(seccomp_data, nr));
    }
    void rule(long call, std::uint32_t result, std::initializer_list<Wanted> wanted) {
        rule(call, result, std::span(wanted.begin(), wanted.size()));
    }
    void load(std::size_t offset) { add(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)); }
    void answer(std::uint32_t result) { add(BPF_RET | BPF_K, result); }
    void add(int what, std::uint32_t operand, std::size_t then = 0, std::size_t otherwise = 0) {
        code_.push_back({static_cast<std::uint16_t>(what), static_cast<std::uint8_t>(then),
                         static_cast<std::uint8_t>(otherwise), operand});
    }

    std::vector<sock_filter> code_;
};

void allow_reading(Filter& filter) {
    // O_TMPFILE contains O_DIRECTORY: use only its other bit.
    constexpr std::uint32_t kWrites =
        O_ACCMODE | O_CREAT | O_TRUNC | O_APPEND | (O_TMPFILE & ~std::uint32_t{O_DIRECTORY});
    filter.allow(SYS_openat, {low_half(2, O_RDONLY, kWrites)});
    filter.lack(SYS_openat2);
    filter.allow({SYS_read, SYS_readv, SYS_pread64, SYS_lseek, SYS_close, SYS_fstat, SYS_newfstatat,
                  SYS_statx, SYS_statfs, SYS_fstatfs, SYS_getdents64, SYS_readlinkat, SYS_faccessat,
                  SYS_faccessat2, SYS_getcwd, SYS_fadvise64, SYS_dup});
    // Without F_SETOWN and F_SETSIG, which can send signals to other processes.
    for (const int command : {F_GETFD, F_SETFD, F_GETFL, F_DUPFD, F_DUPFD_CLOEXEC})
        filter.allow(SYS_fcntl, {low_half(1, static_cast<std::uint32_t>(command))});
#ifdef __x86_64__  // the older architecture also has the older calls
    filter.allow(SYS_open, {low_half(1, O_RDONLY, kWrites)});
    filter.allow({SYS_stat, SYS_lstat, SYS_access, SYS_readlink, SYS_poll, SYS_time});
#endif
}

void allow_writing_to_what_is_open(Filter& filter) {
    filter.allow({SYS_write, SYS_writev, SYS_ppoll});
    filter.allow(
        SYS_sendto,
        {low_half(4, 0), high_half(4, 0)});  // only without an address: to the other end of the connection
    filter.allow(SYS_ioctl, {low_half(1, TCGETS)});  // the test for a terminal
}

void allow_threads(Filter& filter) {
    // A thread must stay in the namespaces of the process; root could otherwise start one with its own.
    constexpr std::uint32_t kNamespaces = CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC |
                                          CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET;
    filter.allow(SYS_clone, {low_half(0, CLONE_THREAD, CLONE_THREAD | kNamespaces)});
}

void allow_memory_and_time(Filter& filter) {
    filter.allow({SYS_brk, SYS_mmap, SYS_munmap, SYS_mremap, SYS_mprotect, SYS_madvise});
    filter.allow({SYS_clock_gettime, SYS_clock_getres, SYS_clock_nanosleep, SYS_nanosleep, SYS_gettimeofday,
                  SYS_getrusage, SYS_sysinfo, SYS_uname, SYS_getrandom, SYS_sched_yield,
                  SYS_sched_getaffinity, SYS_getcpu});
    filter.lack(SYS_clone3);
    filter.allow({SYS_futex, SYS_set_robust_list, SYS_rseq, SYS_exit, SYS_exit_group, SYS_rt_sigaction,
                  SYS_rt_sigprocmask, SYS_rt_sigreturn, SYS_sigaltstack, SYS_restart_syscall, SYS_getpid,
                  SYS_gettid, SYS_getuid, SYS_geteuid, SYS_getgid, SYS_getegid});
    filter.allow(SYS_prctl, {low_half(0, PR_SET_NAME)});
    filter.allow(SYS_tgkill, {low_half(0, static_cast<std::uint32_t>(::getpid()))});  // abort()
    filter.allow(SYS_prlimit64, {low_half(0, 0), low_half(1, RLIMIT_CPU)});
    filter.allow(SYS_prlimit64, {low_half(0, 0), low_half(2, 0), high_half(2, 0)});  // only to read a limit
}

/// If confinement is impossible, the process continues with all its rights.
bool has_filters() {
    const std::uint32_t action = SECCOMP_RET_KILL_PROCESS;
    return ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

}  // namespace

bool confine_this_process(const char* program, NewThreads threads) {
    if (!kConfines) return true;
    int error = 0;
    if (!has_filters() || ::prctl(PR_SET_NO_NEW_PRIVS, 1UL, 0UL, 0UL, 0UL) != 0) error = errno;
    if (error == 0) {
        give_up_privileges();
        Filter filter;
        allow_reading(filter);
        allow_writing_to_what_is_open(filter);
        allow_memory_and_time(filter);
        if (threads == NewThreads::allowed) allow_threads(filter);
        error = filter.install();
    }
    if (error != 0)
        std::fprintf(stderr, "%s: runs without confinement, because the kernel has no such filter: %s\n",
                     program, std::strerror(error));
    return error == 0;
}

}  // namespace octoskin
