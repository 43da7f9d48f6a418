#include "host/apps/version/version.hpp"

namespace octoskin {

std::string program_version(const std::string& program) {
    return program + " " OCTOSKIN_VERSION " (commit " + kCommit +
           (kIsCommitChanged ? ", with changes)" : ")");
}

}  // namespace octoskin
