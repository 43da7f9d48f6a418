// Interface to a source of CAN frames: a log or a socket.
#pragma once

#include <optional>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "host/errors/error.hpp"

namespace octoskin {

struct StampedFrame {
    WallTime stamp;  ///< time of reception
    wire::CanFrame frame;
};

class CanSource {
  public:
    virtual ~CanSource() = default;
    /// The next frame in the order of arrival; empty at the regular end and in every later call.
    [[nodiscard]] virtual Result<std::optional<StampedFrame>, Error> next() = 0;
};

}  // namespace octoskin
