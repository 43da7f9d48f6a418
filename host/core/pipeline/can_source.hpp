// Where frames come from, seen from the core: a log now, a socket later.
#pragma once

#include <optional>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"

namespace octoskin {

struct StampedFrame {
    WallTime stamp;  ///< when it was received
    wire::CanFrame frame;
};

/// Why no further frame will come: what, where and what to do, for a person.
struct CanSourceError {
    std::string what;
};

class CanSource {
  public:
    virtual ~CanSource() = default;
    /// The next frame in the order of arrival; empty at the regular end, and then for ever.
    [[nodiscard]] virtual Result<std::optional<StampedFrame>, CanSourceError> next() = 0;
};

}  // namespace octoskin
