// Reads a world in a separate process: the file and its meshes may be untrusted, and the libraries that read
// them may crash, loop or use all memory.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::sim {

/// Limits for reading a world. The largest shipped world takes 0.2 s, 100 MiB and 0.1 MiB.
struct ReadLimits {
    std::uint64_t memory_mib = 1024;    ///< of address space, including the libraries
    unsigned processor_s = 10;          ///< of processor time
    std::chrono::seconds patience{60};  ///< wall time
    std::uint64_t result_mib = 256;     ///< of triangles
};

/// The program's name; it is in the folder of the other helpers.
inline constexpr const char* kWorldReader = "octoskin-world-read";
/// Its last argument if all files of the world must be below its working directory.
inline constexpr const char* kBeneath = "--beneath";
/// Exit code of a reader that ran out of memory.
inline constexpr int kOutOfMemory = 70;

/// The output of octoskin-world-read for `sdf` (solids_bytes.hpp). If `sdf` is below a named folder, it opens
/// only files of that folder. The error, which has no file, names the limit that was reached, how the process
/// ended, or the missing program (ErrorCode::no_program). `program`: replaces the installed one.
[[nodiscard]] Result<std::string, Error> read_in_process(const FilePlace& sdf, const ReadLimits& limits,
                                                         const std::filesystem::path& program = {});

}  // namespace octoskin::sim
