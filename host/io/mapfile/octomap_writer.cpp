#include "host/io/mapfile/octomap_writer.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/io/mapfile/octree.hpp"

namespace octoskin {
namespace {

/// The resolution in its shortest form that reads back exactly; OctoMap's own six digits are the same for any
/// resolution a person would write.
std::string header(const char* first_line, std::size_t nodes, double resolution_m) {
    return fmt::format(
        "{}\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
        "id OcTree\nsize {}\nres {}\ndata\n",
        first_line, nodes, resolution_m);
}

void append_little_endian(std::string& bytes, std::uint32_t value, unsigned count) {
    for (unsigned i = 0; i < count; ++i) bytes.push_back(static_cast<char>((value >> (8 * i)) & 0xFFU));
}

/// Two bits for each child: 0 unknown, 1 free leaf, 2 occupied leaf, 3 inner node.
class BinaryTreeWriter {
  public:
    BinaryTreeWriter(const std::vector<OctreeNode>& nodes, float log_odds_occupied, std::string& bytes)
        : nodes_(nodes), log_odds_occupied_(log_odds_occupied), bytes_(bytes) {}

    /// Writes the inner node at `at` and those below it; returns the index behind them. Recurses 16 deep at
    /// most, as deep as the tree.
    std::size_t append(std::size_t at) {
        const std::size_t place = bytes_.size();
        append_little_endian(bytes_, 0, 2);
        std::uint32_t codes = 0;
        std::size_t next = at + 1;
        for (unsigned child = 0; child < 8; ++child) {
            if ((nodes_[at].children & (1U << child)) == 0) continue;
            if (nodes_[next].children != 0) {
                codes |= 3U << (2 * child);
                next = append(next);
            } else {
                codes |= (nodes_[next].log_odds >= log_odds_occupied_ ? 2U : 1U) << (2 * child);
                ++next;
            }
        }
        bytes_[place] = static_cast<char>(codes & 0xFFU);
        bytes_[place + 1] = static_cast<char>(codes >> 8U);
        return next;
    }

  private:
    const std::vector<OctreeNode>& nodes_;
    float log_odds_occupied_;
    std::string& bytes_;
};

}  // namespace

std::string encode_ot(const FusedMap& map) {
    const std::vector<OctreeNode> nodes = pruned_octree(map, LeafValues::exact);
    std::string bytes = header("# Octomap OcTree file", nodes.size(), map.resolution_m());
    bytes.reserve(bytes.size() + 5 * nodes.size());
    for (const OctreeNode& node : nodes) {
        append_little_endian(bytes, std::bit_cast<std::uint32_t>(node.log_odds), 4);
        bytes.push_back(static_cast<char>(node.children));
    }
    return bytes;
}

std::string encode_bt(const FusedMap& map) {
    const std::vector<OctreeNode> nodes = pruned_octree(map, LeafValues::max_likelihood);
    std::string bytes = header("# Octomap OcTree binary file", nodes.size(), map.resolution_m());
    if (!nodes.empty()) BinaryTreeWriter(nodes, map.config().log_odds_occupied, bytes).append(0);
    return bytes;
}

}  // namespace octoskin
