// Where depth frames come from, seen from the core: a recording now, a camera later.
#pragma once

#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

/// Why no further frame will come: what, where and what to do, for a person.
struct DepthSourceError {
    std::string what;
    bool is_reader_missing = false;  ///< the program that reads them: nothing is known of the frames
};

class DepthSource {
  public:
    virtual ~DepthSource() = default;
    /// The next frame; empty at the regular end, and then for ever. Capture times never decrease.
    [[nodiscard]] virtual Result<std::optional<DepthFrame>, DepthSourceError> next() = 0;
};

}  // namespace octoskin
