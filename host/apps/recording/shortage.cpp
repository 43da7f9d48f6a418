#include "host/apps/recording/shortage.hpp"

#include <sys/resource.h>

#include <cerrno>
#include <new>
#include <string>
#include <system_error>

namespace octoskin {
namespace {

constexpr rlim_t kMib = rlim_t{1} << 20U;

/// Empty if there is no limit.
std::optional<rlim_t> limit_of(__rlimit_resource resource) {
    rlimit limit{};
    if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
    return limit.rlim_cur;
}

std::string with_limit(const std::string& what, __rlimit_resource resource, rlim_t unit,
                       const std::string& unit_name, const std::string& remedy) {
    const auto limit = limit_of(resource);
    if (!limit) return what + ": " + remedy;
    const std::string most = std::to_string(*limit / unit) + unit_name;
    return what + ": this process may have " + most + "; " + remedy;
}

std::string no_memory() {
    if (!limit_of(RLIMIT_AS) && limit_of(RLIMIT_DATA))
        return with_limit("out of memory", RLIMIT_DATA, kMib, " MiB of data", "raise that limit (ulimit -d)");
    if (!limit_of(RLIMIT_AS)) return "out of memory: end other programs, or give this one more";
    return with_limit("out of memory", RLIMIT_AS, kMib, " MiB of addresses", "raise that limit (ulimit -v)");
}

/// A thread's stack takes from the process's address space and data, and the thread counts as a process of
/// its user.
std::string no_thread() {
    if (limit_of(RLIMIT_AS))
        return with_limit("no thread can be started", RLIMIT_AS, kMib, " MiB of addresses",
                          "raise that limit (ulimit -v), or those of threads (ulimit -u, TasksMax=)");
    if (limit_of(RLIMIT_DATA))
        return with_limit("no thread can be started", RLIMIT_DATA, kMib, " MiB of data",
                          "raise that limit (ulimit -d), or those of threads (ulimit -u, TasksMax=)");
    return with_limit("no thread can be started", RLIMIT_NPROC, 1, " with all others of its user",
                      "raise that limit (ulimit -u), or the service's TasksMax=");
}

std::string words(int error_number) {
    switch (error_number) {
        case EMFILE:
            return with_limit("no descriptor left", RLIMIT_NOFILE, 1, " open at once",
                              "raise that limit (ulimit -n)");
        case ENFILE:
            return "the system has no descriptor left: end other programs, or raise fs.file-max";
        case EAGAIN:
            return no_thread();
        case ENOMEM:
            return no_memory();
        case EFBIG:
            return with_limit("the file would be too large", RLIMIT_FSIZE, 1, " bytes in one",
                              "raise that limit (ulimit -f)");
        default:
            return {};
    }
}

}  // namespace

std::optional<AppError> shortage_in(const std::exception& thrown) {
    if (dynamic_cast<const std::bad_alloc*>(&thrown) != nullptr)
        return AppError{ExitCode::no_resources, no_memory()};
    const auto* const failed = dynamic_cast<const std::system_error*>(&thrown);
    if (failed == nullptr) return std::nullopt;
    const std::error_category& category = failed->code().category();
    if (category != std::generic_category() && category != std::system_category()) return std::nullopt;
    const std::string what = words(failed->code().value());
    if (what.empty()) return std::nullopt;
    return AppError{ExitCode::no_resources, what + " (" + failed->what() + ")"};
}

std::string reason_of(const std::exception& thrown) {
    const auto shortage = shortage_in(thrown);
    return shortage ? shortage->message : thrown.what();
}

}  // namespace octoskin
