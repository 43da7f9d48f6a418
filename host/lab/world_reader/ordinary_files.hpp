// This program's fopen(), which its libraries call too, opens ordinary files only: a library cannot block on
// a pipe.
#pragma once

#include <string>

namespace octoskin::sim {

/// "/dir/a.sdf, which is a named pipe": the first file that was refused because it is not an ordinary file.
/// Empty if there is none.
[[nodiscard]] std::string refused_file();

}  // namespace octoskin::sim
