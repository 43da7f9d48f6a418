// That the libraries wait at no pipe: fopen() of this program, which theirs is too, opens ordinary files
// alone.
#pragma once

#include <string>

namespace octoskin::sim {

/// "/dir/a.sdf, which is a named pipe": the first file that was refused because it is something else. Empty
/// if there is none.
[[nodiscard]] std::string refused_file();

}  // namespace octoskin::sim
