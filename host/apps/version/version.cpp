#include "host/apps/version/version.hpp"

namespace octoskin {

std::string program_version() {
    return std::string("octoskin " OCTOSKIN_VERSION " (commit ") + kCommit +
           (kIsCommitChanged ? ", with changes)" : ")");
}

}  // namespace octoskin
