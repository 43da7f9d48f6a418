#include "host/apps/command_line/standard_output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>

namespace octoskin::app {
namespace {

int first_error = 0;  ///< errno of the first write that failed

void note(bool is_done) {
    if (!is_done && first_error == 0) first_error = errno == 0 ? EIO : errno;
}

}  // namespace

void reserve_standard_descriptors() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
        // open() returns the lowest free number, which is `descriptor`. The opposite access mode makes every
        // later write to it (or read from it) fail instead of being lost without an error.
        static_cast<void>(::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
    }
}

void print_exactly(std::string_view text) {
    errno = 0;
    note(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

void print_json(std::string_view json) {
    print_exactly(printable_json(json));
}

void print_text(std::string_view text) {
    print_exactly(printable_lines(text));
}

std::optional<AppError> flush_standard_output() {
    errno = 0;
    note(std::fflush(stdout) == 0 && std::ferror(stdout) == 0);
    if (first_error == 0 || first_error == EPIPE) return std::nullopt;
    return AppError{ExitCode::io_failed,
                    {.code = ErrorCode::system_error,
                     .what = "cannot write (" + std::generic_category().message(first_error) + ")",
                     .file = "standard output",
                     .others = "The printed output is incomplete; files that were written are complete"}};
}

}  // namespace octoskin::app
