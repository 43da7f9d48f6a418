// Version and commit of this build: for `--version`, recordings, metrics and reports.
#pragma once

#include <string>

namespace octoskin {

/// The first 12 digits of the built commit; "unknown" if the source was not a clone.
extern const char* const kCommit;
/// Whether files of the clone differed from that commit.
extern const bool kIsCommitChanged;

/// "octoskin 0.1.0 (commit 0123456789ab, with changes)".
[[nodiscard]] std::string program_version(const std::string& program = "octoskin");

}  // namespace octoskin
