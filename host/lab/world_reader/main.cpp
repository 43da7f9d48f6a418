// octoskin-world-read MEMORY_MIB PROCESSOR_S FILE [--beneath]: writes the solids of an SDF file to standard
// output, in the format of solids_bytes.hpp. A separate process with limits, because the libraries that read
// the file are not trusted. With --beneath it reads no file outside its working directory.
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "host/io/helper_limits/confinement.hpp"
#include "host/io/helper_limits/helper_limits.hpp"
#include "host/lab/world_reader/folder_files.hpp"
#include "host/lab/world_reader/sdf_module_load.hpp"
#include "hw/sim/world/reader_process.hpp"

namespace octoskin::sim {
namespace {

struct Limits {
    std::uint64_t memory_mib = 0;
    std::uint64_t processor_s = 0;
};

bool take_number(std::string_view text, std::uint64_t& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size() && number > 0;
}

void limit(const Limits& limits) {
    limit_this_process({.memory_mib = limits.memory_mib, .exit_without_memory = kOutOfMemory});
    limit_processor_seconds(limits.processor_s);
    // It writes to a pipe only. Without HOME, sdformat creates no folder and no log file.
    octoskin::limit_file_size(0);
    ::unsetenv("HOME");
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
    if (!files) return unexpected(files.error());
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
            "`octoskin-lab simulate` runs it.\n",
            stderr);
        return 2;
    }
    limit(limits);
    const int output = octoskin::take_standard_output();
    const bool is_confined =
        octoskin::confine_this_process("octoskin-world-read", octoskin::NewThreads::refused);
    auto solids = read(argv[3], is_beneath);
    if (!is_confined && solids)
        solids->warnings.emplace_back(
            "was read without confinement: the kernel has no system call filter here");
    const bool is_written = write_all(output, to_bytes(solids));
    ::_exit(is_written ? 0 : 1);  // the libraries' destructors take time and have no use
}
