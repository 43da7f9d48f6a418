// Ways to lay a trap in a folder that a command is given: what leads out of it, or waits for ever.
#pragma once

#include <cstdint>
#include <filesystem>

namespace octoskin {

enum class Trap : std::uint8_t {
    link_to_file,     ///< the very file that belongs there, but outside: following it would go well
    absolute_link,    ///< the same by its absolute path
    link_to_folder,   ///< of the victim
    link_to_nothing,  ///< that is not there yet, in the victim's folder
    hard_link,        ///< to that file outside
    pipe,
    device,
    folder,
};

/// Lays it at `at`, in place of what is there. `twin`: the file outside that belongs there; `victim`: the
/// folder outside. False: this user, or this file system, cannot lay such a trap.
[[nodiscard]] bool lay(Trap trap, const std::filesystem::path& at, const std::filesystem::path& twin,
                       const std::filesystem::path& victim);

}  // namespace octoskin
