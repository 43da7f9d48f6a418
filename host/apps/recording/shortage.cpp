#include "host/apps/recording/shortage.hpp"

#include <sys/resource.h>

#include <cerrno>
#include <new>
#include <string>
#include <system_error>
#include <utility>

namespace octoskin {
namespace {

constexpr rlim_t kMib = rlim_t{1} << 20U;

/// Empty if there is no limit.
std::optional<rlim_t> limit_of(__rlimit_resource resource) {
    rlimit limit{};
    if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
    return limit.rlim_cur;
}

Error with_limit(const std::string& what, __rlimit_resource resource, rlim_t unit,
                 const std::string& unit_name, const std::string& remedy) {
    const auto limit = limit_of(resource);
    const std::string most =
        limit ? "; this process may have " + std::to_string(*limit / unit) + unit_name : std::string();
    return {.code = ErrorCode::no_resources, .what = what + most, .remedy = remedy};
}

Error no_memory() {
    if (!limit_of(RLIMIT_AS) && limit_of(RLIMIT_DATA))
        return with_limit("out of memory", RLIMIT_DATA, kMib, " MiB of data", "raise that limit (ulimit -d)");
    if (!limit_of(RLIMIT_AS)) {
        return {.code = ErrorCode::no_resources,
                .what = "out of memory",
                .remedy = "end other programs, or give this one more"};
    }
    return with_limit("out of memory", RLIMIT_AS, kMib, " MiB of addresses", "raise that limit (ulimit -v)");
}

/// A thread's stack takes from the process's address space and data, and the thread counts as a process of
/// its user.
Error no_thread() {
    if (limit_of(RLIMIT_AS))
        return with_limit("no thread can be started", RLIMIT_AS, kMib, " MiB of addresses",
                          "raise that limit (ulimit -v), or those of threads (ulimit -u, TasksMax=)");
    if (limit_of(RLIMIT_DATA))
        return with_limit("no thread can be started", RLIMIT_DATA, kMib, " MiB of data",
                          "raise that limit (ulimit -d), or those of threads (ulimit -u, TasksMax=)");
    return with_limit("no thread can be started", RLIMIT_NPROC, 1, " with all others of its user",
                      "raise that limit (ulimit -u), or the service's TasksMax=");
}

/// Empty if it is the number of another fault.
std::optional<Error> described(int error_number) {
    switch (error_number) {
        case EMFILE:
            return with_limit("no descriptor left", RLIMIT_NOFILE, 1, " open at once",
                              "raise that limit (ulimit -n)");
        case ENFILE:
            return Error{.code = ErrorCode::no_resources,
                         .what = "the system has no descriptor left",
                         .remedy = "end other programs, or raise fs.file-max"};
        case EAGAIN:
            return no_thread();
        case ENOMEM:
            return no_memory();
        case EFBIG: {
            Error error = with_limit("the file would be too large", RLIMIT_FSIZE, 1, " bytes in one",
                                     "raise that limit (ulimit -f)");
            error.code = ErrorCode::too_large;
            return error;
        }
        default:
            return std::nullopt;
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
    auto error = described(failed->code().value());
    if (!error) return std::nullopt;
    error->what += std::string(" (") + failed->what() + ")";
    return AppError{ExitCode::no_resources, std::move(*error)};
}

Error error_in(const std::exception& thrown) {
    auto shortage = shortage_in(thrown);
    return shortage ? std::move(shortage->error) : Error{ErrorCode::system_error, thrown.what()};
}

std::string reason_of(const std::exception& thrown) {
    return error_in(thrown).message();
}

}  // namespace octoskin
