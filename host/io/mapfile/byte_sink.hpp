// A file's bytes piece by piece, so that they need not be in memory all at once.
#pragma once

#include <functional>
#include <string_view>

namespace octoskin {

/// Takes the next bytes, in order. False: it failed, and no more bytes are needed.
using ByteSink = std::function<bool(std::string_view bytes)>;
/// Passes all its bytes to a sink, until that returns false. A piece is large enough for a system call of its
/// own.
using ByteSource = std::function<void(const ByteSink& sink)>;

}  // namespace octoskin
