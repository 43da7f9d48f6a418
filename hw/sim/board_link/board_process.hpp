// An emulated board in a process of its own, seen from the simulator.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "hw/sim/board_link/link_socket.hpp"

namespace octoskin::sim {

class BoardProcess {
  public:
    using Eyes = std::function<RangingReturn(const WhatIsSeen& question)>;
    /// Starts `program` with `arguments` and the option that hands it its end of the socket. `eyes` answers
    /// what sensors see. Throws BoardLinkError if it cannot be started.
    BoardProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments, Eyes eyes);
    /// Closes the socket, which ends the process, and waits for it.
    ~BoardProcess();
    BoardProcess(const BoardProcess&) = delete;
    BoardProcess& operator=(const BoardProcess&) = delete;

    /// The board runs from here on, while others may too.
    void begin(const RunUntil& turn);
    /// Waits for its end, answering questions meanwhile.
    [[nodiscard]] HasRun finish();
    [[nodiscard]] BoardSummary summary();

  private:
    [[nodiscard]] BoardMessage next();

    pid_t child_ = -1;
    std::optional<LinkSocket> socket_;
    Eyes eyes_;
};

}  // namespace octoskin::sim
