// Lines to a descriptor whose reader may stop: a thread of its own writes them, so that the node never waits.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <thread>

#include "common/time.hpp"

namespace octoskin::linux_port {

class LineWriter {
  public:
    /// So many lines wait; a further one is dropped, and the next that is written comes after one that tells
    /// how many were.
    static constexpr std::size_t kLinesMax = 1000;

    /// `descriptor` must stay open for the life of the process, and blocks. Throws std::system_error if there
    /// is no thread to be had.
    explicit LineWriter(int descriptor, Microseconds end_patience = std::chrono::seconds{1});
    /// Writes what waits; a write that hangs is left behind after the patience.
    ~LineWriter();
    LineWriter(const LineWriter&) = delete;
    LineWriter& operator=(const LineWriter&) = delete;

    /// A whole line with its line feed, in one write. From any thread; never waits.
    void add(std::string line);

  private:
    struct Work;
    static void run(Work& work);

    std::shared_ptr<Work> work_;  ///< the thread may outlive the writer
    Microseconds end_patience_;
    std::thread thread_;
};

}  // namespace octoskin::linux_port
