// Log lines for registers that the sensors of a node read alike, with another value than was written. This is
// no problem; each is logged once in the daemon's life.
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
    /// The lines to log now; O(nodes * registers).
    [[nodiscard]] std::vector<std::string> news(const NodeRegistry& nodes);

  private:
    std::set<std::tuple<wire::NodeId, std::uint8_t, std::uint8_t>> reported_;  ///< node, register, read
};

}  // namespace octoskin
