#include "host/core/black_box/dump_assembler.hpp"

#include <cstddef>
#include <utility>

#include "common/wire/black_box.hpp"

namespace octoskin {
namespace {

/// Length of the whole dump in bytes; empty until its header has arrived.
std::optional<std::size_t> size_of(const Dump& dump) {
    const auto header = wire::decode_dump_header(dump.bytes);
    if (!header) {
        return std::nullopt;
    }
    return sizeof(header->length) + header->length;
}

std::size_t pieces_of(std::size_t bytes) {
    constexpr std::size_t kBytes = decltype(wire::BlackBox::bytes){}.size();
    return (bytes + kBytes - 1) / kBytes;
}

}  // namespace

std::size_t Dump::pieces_came() const {
    return pieces_of(bytes.size());
}

std::optional<std::size_t> Dump::pieces() const {
    const auto size = size_of(*this);
    if (!size) return std::nullopt;
    return pieces_of(*size);
}

std::optional<Dump> DumpAssembler::take(wire::NodeId node, const wire::BlackBox& piece) {
    const auto known = open_.find(node);
    const bool goes_on = known != open_.end() && known->second.bus == piece.bus &&
                         known->second.number == piece.dump && next_index_[node] == piece.index;
    std::optional<Dump> ended;
    if (!goes_on) {
        ended = close(node);
        if (piece.index != 0) {
            return ended;
        }
        open_[node] = {.node = node, .bus = piece.bus, .number = piece.dump, .bytes = {}};
    }
    Dump& dump = open_.at(node);
    dump.bytes.insert(dump.bytes.end(), piece.bytes.begin(), piece.bytes.end());
    next_index_[node] = static_cast<std::uint16_t>(piece.index + 1U);
    const auto size = size_of(dump);
    if (size && dump.bytes.size() >= *size) {
        dump.bytes.resize(*size);
        dump.is_complete = true;
        return close(node);  // an abandoned dump was longer than one piece, and so is this one
    }
    return ended;
}

std::optional<Dump> DumpAssembler::close(wire::NodeId node) {
    const auto known = open_.find(node);
    if (known == open_.end()) {
        return std::nullopt;
    }
    Dump dump = std::move(known->second);
    open_.erase(known);
    return dump;
}

std::vector<Dump> DumpAssembler::finish() {
    std::vector<Dump> rest;
    for (auto& [node, dump] : open_) {
        rest.push_back(std::move(dump));
    }
    open_.clear();
    return rest;
}

}  // namespace octoskin
