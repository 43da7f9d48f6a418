// Writes lines to a descriptor whose reader may stop. A separate thread writes, so that the node never waits.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <thread>

#include "common/time.hpp"

namespace octoskin::linux_port {

class LineWriter {
  public:
    /// Maximum number of queued lines. Further lines are dropped; the next line written is preceded by one
    /// with the number of dropped lines.
    static constexpr std::size_t kLinesMax = 1000;

    /// `descriptor` must stay open for the life of the process; writes to it may block. Throws
    /// std::system_error if no thread can be started.
    explicit LineWriter(int descriptor, Microseconds end_patience = std::chrono::seconds{1});
    /// Writes the queued lines. A write that hangs is abandoned after `end_patience`.
    ~LineWriter();
    LineWriter(const LineWriter&) = delete;
    LineWriter& operator=(const LineWriter&) = delete;

    /// Queues one line, which must include its line feed; it is written in one write. Thread-safe; never
    /// waits.
    void add(std::string line);

  private:
    struct Work;
    static void run(Work& work);

    std::shared_ptr<Work> work_;  ///< shared, since the thread may outlive the writer
    Microseconds end_patience_;
    std::thread thread_;
};

}  // namespace octoskin::linux_port
