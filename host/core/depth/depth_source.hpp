// The core's interface to a source of depth frames: a recording or a camera.
#pragma once

#include <optional>

#include "common/result.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/errors/error.hpp"

namespace octoskin {

class DepthSource {
  public:
    virtual ~DepthSource() = default;
    /// The next frame; empty at the regular end and in all later calls. Capture times never decrease.
    /// ErrorCode::no_program: the program that reads the frames is missing, and nothing is known of them.
    [[nodiscard]] virtual Result<std::optional<DepthFrame>, Error> next() = 0;
};

}  // namespace octoskin
