// A file's bytes piece by piece, for files that are not worth the memory of all of them at once.
#pragma once

#include <functional>
#include <string_view>

namespace octoskin {

/// Takes the next bytes, in order. False: they could not be kept, and no more need come.
using ByteSink = std::function<bool(std::string_view bytes)>;
/// Gives all of its bytes to a sink, or as many as that takes. Pieces are worth a system call each.
using ByteSource = std::function<void(const ByteSink& sink)>;

}  // namespace octoskin
