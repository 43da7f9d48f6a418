// octoskin-world-read MEMORY_MIB PROCESSOR_S FILE [--beneath]: the solids of an SDF file to standard output,
// as solids_bytes.hpp has them. The libraries behind it may crash, run in circles or take all memory: that is
// why this is a process of its own. Beneath its working directory it reads nothing outside of that.
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <string_view>

#include "host/apps/world_reader/folder_files.hpp"
#include "host/apps/world_reader/sdf_module_load.hpp"
#include "hw/sim/world/reader_process.hpp"

namespace octoskin::sim {
namespace {

// The sanitizers reserve terabytes of addresses, which no limit would let them.
#ifdef OCTOSKIN_SANITIZED
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

struct Limits {
    rlim_t memory_mib = 0;
    rlim_t processor_s = 0;
};

bool take_number(std::string_view text, rlim_t& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size() && number > 0;
}

void limit(int resource, rlim_t most) {
    const rlimit both{most, most};
    ::setrlimit(resource, &both);
}

void limit_this_process(const Limits& limits) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    limit(RLIMIT_CORE, 0);
    // It writes to a pipe alone; and sdformat is given no home to write its log to.
    ::signal(SIGXFSZ, SIG_IGN);
    limit(RLIMIT_FSIZE, 0);
    ::setenv("HOME", "/nonexistent", 1);
    if (kLimitsMemory) limit(RLIMIT_AS, limits.memory_mib << 20U);
    const rlimit processor{limits.processor_s, limits.processor_s + 1};  // SIGXCPU first, which says why
    ::setrlimit(RLIMIT_CPU, &processor);
    std::set_new_handler([] { ::_exit(kOutOfMemory); });
}

/// Moves standard output away: what the libraries print goes to standard error, never into the result.
int take_standard_output() {
    const int output = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    ::dup2(STDERR_FILENO, STDOUT_FILENO);
    return output;
}

bool write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

SolidsOrError read(const std::filesystem::path& sdf, bool is_beneath) {
    if (!is_beneath) return load_solids(sdf, nullptr);
    const auto files = FolderFiles::open(".");
    if (!files) return unexpected(WorldError{{}, "", files.error()});
    return load_solids(sdf, files->get());
}

}  // namespace
}  // namespace octoskin::sim

int main(int argc, char** argv) {
    using namespace octoskin::sim;
    Limits limits;
    const bool is_beneath = argc == 5 && std::string_view(argv[4]) == kBeneath;
    if ((argc != 4 && !is_beneath) || !take_number(argv[1], limits.memory_mib) ||
        !take_number(argv[2], limits.processor_s)) {
        std::fputs(
            "usage: octoskin-world-read MEMORY_MIB PROCESSOR_S FILE [--beneath] > solids\nA helper of "
            "octoskin; "
            "`octoskin simulate` runs it.\n",
            stderr);
        return 2;
    }
    limit_this_process(limits);
    const int output = take_standard_output();
    const bool is_written = write_all(output, to_bytes(read(argv[3], is_beneath)));
    ::_exit(is_written ? 0 : 1);  // the libraries' ends take time and give nothing
}
