// An emulated board in a separate process: the simulator's side.
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
    /// Starts `program` with `arguments` and the option that passes its end of the socket. `eyes` returns the
    /// sensors' views. Throws BoardLinkError if it cannot be started.
    BoardProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments, Eyes eyes);
    /// Closes the socket, which ends the process, and waits for it.
    ~BoardProcess();
    BoardProcess(const BoardProcess&) = delete;
    BoardProcess& operator=(const BoardProcess&) = delete;

    /// Starts a turn of the board. Several boards may run at once.
    void begin(const RunUntil& turn);
    /// Waits for the end of the turn and answers the board's questions.
    [[nodiscard]] HasRun finish();
    [[nodiscard]] BoardSummary summary();

  private:
    [[nodiscard]] BoardMessage next();

    pid_t child_ = -1;
    std::optional<LinkSocket> socket_;
    Eyes eyes_;
};

}  // namespace octoskin::sim
