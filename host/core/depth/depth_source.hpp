// The core's interface to a source of depth frames: a recording or a camera.
#pragma once

#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

/// Why no further frame follows: fault, place and remedy, as text for the user.
struct DepthSourceError {
    std::string what;
    bool is_reader_missing = false;  ///< the program that reads them is missing: nothing is known of them
};

class DepthSource {
  public:
    virtual ~DepthSource() = default;
    /// The next frame; empty at the regular end and in all later calls. Capture times never decrease.
    [[nodiscard]] virtual Result<std::optional<DepthFrame>, DepthSourceError> next() = 0;
};

}  // namespace octoskin
