// The process in which a world is read: the file and its meshes may be anybody's, and the libraries behind
// them may crash, run in circles or take all memory.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::sim {

/// What reading a world may take. The largest of the shipped ones takes 0.2 s, 100 MiB and 0.1 MiB.
struct ReadLimits {
    std::uint64_t memory_mib = 1024;    ///< of addresses, the libraries' own included
    unsigned processor_s = 10;          ///< of processor time
    std::chrono::seconds patience{60};  ///< by the clock
    std::uint64_t result_mib = 256;     ///< of triangles
};

/// The program's name, which lies where the other helpers do.
inline constexpr const char* kWorldReader = "octoskin-world-read";
/// Its last argument for a world all of whose files are below its working directory.
inline constexpr const char* kBeneath = "--beneath";
/// Exit code of a reader that ran out of memory.
inline constexpr int kOutOfMemory = 70;

struct ReadFault {
    std::string what;
    bool is_reader_missing = false;  ///< there is no program that reads, or it cannot be started
};

/// What octoskin-world-read writes about `sdf` (solids_bytes.hpp). If that is below a folder that was named,
/// it opens nothing but files of that folder. The error says which limit was reached, how the process ended,
/// or that there is no such program. `program`: in place of the installed one.
[[nodiscard]] Result<std::string, ReadFault> read_in_process(const FilePlace& sdf, const ReadLimits& limits,
                                                             const std::filesystem::path& program = {});

}  // namespace octoskin::sim
