// What is no problem and yet worth a line: a register that the sensors of a node read alike, otherwise than
// it is written. Each once, for as long as the daemon runs.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "host/core/ingest/node_registry.hpp"

namespace octoskin {

class RegisterLog {
  public:
    /// The lines that are to be logged now; O(nodes * registers).
    [[nodiscard]] std::vector<std::string> news(const NodeRegistry& nodes);

  private:
    std::set<std::tuple<wire::NodeId, std::uint8_t, std::uint8_t>> told_;  ///< node, register, read
};

}  // namespace octoskin
