#include "host/io/mapfile/octomap_writer.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "host/io/mapfile/octomap_header.hpp"
#include "host/io/mapfile/octree.hpp"

namespace octoskin {
namespace {

char* put_little_endian(char* place, std::uint32_t value, unsigned count) {
    for (unsigned i = 0; i < count; ++i) *place++ = static_cast<char>((value >> (8 * i)) & 0xFFU);
    return place;
}

/// Bit i: child i exists.
constexpr std::uint32_t which_exist(std::uint32_t children) {
    std::uint32_t bits = (children | (children >> 1U)) & 0x5555U;
    bits = (bits | (bits >> 1U)) & 0x3333U;
    bits = (bits | (bits >> 2U)) & 0x0F0FU;
    return (bits | (bits >> 4U)) & 0x00FFU;
}

/// A node's log-odds, and a bit for each child.
struct OtNode {
    static constexpr std::size_t kBytes = 5;
    static bool is_written(const OctreeNode&) { return true; }
    static char* put(char* place, const OctreeNode& node) {
        place = put_little_endian(place, std::bit_cast<std::uint32_t>(node.log_odds), 4);
        return put_little_endian(place, which_exist(node.children), 1);
    }
};

/// For inner nodes only: two bits for each child.
struct BtNode {
    static constexpr std::size_t kBytes = 2;
    static bool is_written(const OctreeNode& node) { return node.state == NodeState::inner; }
    static char* put(char* place, const OctreeNode& node) {
        return put_little_endian(place, node.children, 2);
    }
};

template <class Node>
void write_nodes(const PrunedOctree& octree, const ByteSink& sink) {
    std::string bytes;
    octree.for_each([&](std::span<const OctreeNode> nodes) {
        bytes.resize(Node::kBytes * nodes.size());
        char* place = bytes.data();
        for (const OctreeNode& node : nodes) {
            if (Node::is_written(node)) place = Node::put(place, node);
        }
        return sink({bytes.data(), static_cast<std::size_t>(place - bytes.data())});
    });
}

std::string all_bytes(const ByteSource& source) {
    std::string all;
    source([&all](std::string_view bytes) {
        all += bytes;
        return true;
    });
    return all;
}

void write_all_ot(const FusedMap& map, const ByteSink& sink, SavedMark mark) {
    const PrunedOctree octree(map, LeafValues::exact);
    if (sink(octomap_header(false, octree.size(), map.resolution_m(), mark, map.config().log_odds_occupied)))
        write_nodes<OtNode>(octree, sink);
}

}  // namespace

void write_ot(const FusedMap& map, const ByteSink& sink) {
    write_all_ot(map, sink, SavedMark::present);
}

void write_unmarked_ot(const FusedMap& map, const ByteSink& sink) {
    write_all_ot(map, sink, SavedMark::absent);
}

void write_bt(const FusedMap& map, const ByteSink& sink) {
    const PrunedOctree octree(map, LeafValues::max_likelihood);
    if (sink(octomap_header(true, octree.size(), map.resolution_m()))) write_nodes<BtNode>(octree, sink);
}

std::string encode_ot(const FusedMap& map) {
    return all_bytes([&map](const ByteSink& sink) { write_ot(map, sink); });
}

std::string encode_bt(const FusedMap& map) {
    return all_bytes([&map](const ByteSink& sink) { write_bt(map, sink); });
}

}  // namespace octoskin
