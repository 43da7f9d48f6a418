// Assembles the pieces of BLACK_BOX dumps of any number of nodes and buses at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "common/wire/messages.hpp"

namespace octoskin {

/// The bytes of one dump that have arrived.
struct Dump {
    wire::NodeId node = 0;
    std::uint8_t bus = 0;
    std::uint8_t number = 0;  ///< the node's dump counter, modulo 4
    std::vector<std::uint8_t> bytes;
    bool is_complete = false;  ///< false: the rest after `bytes` is missing

    [[nodiscard]] std::size_t pieces_came() const;
    /// Number of pieces of the whole dump; empty until its length has arrived.
    [[nodiscard]] std::optional<std::size_t> pieces() const;
};

class DumpAssembler {
  public:
    /// Returns the dump that this piece completes. Also returns an incomplete dump that this piece ends, by a
    /// gap or as the first piece of another dump. Pieces before the first piece of a dump are ignored.
    [[nodiscard]] std::optional<Dump> take(wire::NodeId node, const wire::BlackBox& piece);
    /// The dumps that are incomplete at the end of a log.
    [[nodiscard]] std::vector<Dump> finish();

  private:
    std::map<wire::NodeId, Dump> open_;  ///< a node sends one dump after the other
    std::map<wire::NodeId, std::uint16_t> next_index_;

    [[nodiscard]] std::optional<Dump> close(wire::NodeId node);
};

}  // namespace octoskin
