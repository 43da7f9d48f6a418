// Puts the pieces of BLACK_BOX dumps together, of any number of nodes and buses at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "common/wire/messages.hpp"

namespace octoskin {

/// The bytes of one dump as far as they came.
struct Dump {
    wire::NodeId node = 0;
    std::uint8_t bus = 0;
    std::uint8_t number = 0;  ///< the node's count of its dumps, modulo 4
    std::vector<std::uint8_t> bytes;
    bool is_complete = false;  ///< false: what follows `bytes` never came

    [[nodiscard]] std::size_t pieces_came() const;
    /// Of the whole dump; empty before its length came.
    [[nodiscard]] std::optional<std::size_t> pieces() const;
};

class DumpAssembler {
  public:
    /// The dump that this piece ends, or that it shows to have been given up: by a gap, or by the beginning
    /// of another one. Pieces before the first of a dump are ignored.
    [[nodiscard]] std::optional<Dump> take(wire::NodeId node, const wire::BlackBox& piece);
    /// What is still open, at the end of a log.
    [[nodiscard]] std::vector<Dump> finish();

  private:
    std::map<wire::NodeId, Dump> open_;  ///< a node sends one dump after the other
    std::map<wire::NodeId, std::uint16_t> next_index_;

    [[nodiscard]] std::optional<Dump> close(wire::NodeId node);
};

}  // namespace octoskin
