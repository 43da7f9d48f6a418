// A channel whose messages differ from reader to reader: each gets what it lacks.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/time.hpp"

namespace octoskin::view {

struct StreamMessage {
    std::string payload;
    WallTime when{0};
};

/// What one reader lacks.
class MessageStream {
  public:
    virtual ~MessageStream() = default;
    /// The next message; empty: the reader has all. Throws std::bad_alloc.
    [[nodiscard]] virtual std::optional<StreamMessage> next() = 0;
};

class StreamSource {
  public:
    virtual ~StreamSource() = default;
    /// For a new reader, which lacks everything. The source must outlive the stream.
    [[nodiscard]] virtual std::unique_ptr<MessageStream> stream() = 0;
};

}  // namespace octoskin::view
