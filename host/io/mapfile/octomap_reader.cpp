#include "host/io/mapfile/octomap_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <optional>

#include "host/core/voxels/morton.hpp"
#include "host/io/mapfile/octomap_header.hpp"
#include "host/io/mapfile/octree.hpp"

namespace octoskin {
namespace {

using LeafVisitor = std::function<bool(const VoxelCube&, float log_odds)>;  // false: stop, there is no room

/// Walks the nodes of a file without recursion, checks each, and passes on the leaves. Both formats share the
/// walk; only the bytes of a node differ.
class TreeWalk {
  public:
    TreeWalk(std::string_view bytes, const OctomapHeader& header, const MapReadLimits& limits)
        : bytes_(bytes), position_(header.data_begin), header_(header), config_(limits.map) {
        nodes_max_ = header.is_octoskins ? *header.nodes : limits.nodes_max;
        config_.resolution_m = header.resolution_m;
    }

    std::optional<MapReadError> walk(const LeafVisitor& visit) {
        if (!is_empty()) {
            if (auto fault = walk_nodes(visit)) return fault;
        }
        if (nodes_ > nodes_max_ && !header_.is_octoskins)
            return error(MapFault::too_many_nodes, fmt::format("more than {} nodes", nodes_max_));
        return check_end();
    }

    /// How the end of the tree differs from the header; empty if it does not.
    [[nodiscard]] std::string why_end_differs() const {
        if (!header_.nodes || *header_.nodes != nodes_)
            return fmt::format("size is {}, the tree has {} nodes", said_nodes(), nodes_);
        if (bytes_behind() > 0) return fmt::format("{} bytes after the last node", bytes_behind());
        return {};
    }

  private:
    /// A child's code in a .bt, two bits; 0 is unknown.
    static constexpr std::uint32_t kFreeLeaf = 1;
    static constexpr std::uint32_t kInner = 3;

    struct Node {
        MortonCode first = 0;  ///< its lowest voxel
        unsigned height = 0;   ///< its edge is 2^height voxels
        std::uint32_t code = kInner;
    };
    /// A node whose children are being read.
    struct Open {
        Node node;
        unsigned next = 0;        ///< next child to examine
        std::uint32_t codes = 0;  ///< two bits a child
    };
    struct Content {
        float log_odds = 0.0F;    ///< of a leaf
        std::uint32_t codes = 0;  ///< of the children, two bits each; 0: a leaf
    };

    MapReadError error(MapFault fault, const std::string& what) const {
        return {fault, fmt::format("byte {}: {}", position_, what)};
    }
    [[nodiscard]] std::size_t bytes_behind() const { return bytes_.size() - position_; }
    [[nodiscard]] std::string said_nodes() const {
        return header_.nodes ? fmt::format("{}", *header_.nodes) : "not known";
    }
    /// The header gives zero nodes. Some other programs write zero for a tree whose nodes they did not count.
    [[nodiscard]] bool is_empty() const {
        return header_.nodes == 0U && (header_.is_octoskins || bytes_behind() == 0);
    }

    /// A file from octoskin must end as its header says. For another program's file one of two must confirm
    /// the tree: the number of nodes, or that tree and file end together.
    [[nodiscard]] std::optional<MapReadError> check_end() const {
        const bool has_said_nodes = header_.nodes && *header_.nodes == nodes_;
        const bool ends_with_file = bytes_behind() == 0;
        if (header_.is_octoskins ? has_said_nodes && ends_with_file : has_said_nodes || ends_with_file)
            return std::nullopt;
        if (has_said_nodes) return error(MapFault::trailing_bytes, why_end_differs());
        return error(MapFault::node_count_differs,
                     fmt::format("{} nodes, but the header has {}", nodes_, said_nodes()));
    }

    MapReadError truncated() const { return error(MapFault::truncated, "the data end within the tree"); }
    MapReadError no_room() const {
        return error(MapFault::no_room,
                     fmt::format("the voxels need more than {} MiB", config_.memory_max_mib));
    }

    std::optional<std::uint32_t> take(unsigned count) {
        if (bytes_.size() - position_ < count) return std::nullopt;
        std::uint32_t value = 0;
        for (unsigned i = 0; i < count; ++i) {
            value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes_[position_ + i])) << (8 * i);
        }
        position_ += count;
        return value;
    }

    std::optional<MapReadError> walk_nodes(const LeafVisitor& visit) {
        std::optional<Node> node = Node{0, kOctreeDepth, kInner};
        for (; node && nodes_ <= nodes_max_; node = next_node()) {
            ++nodes_;
            const auto content = header_.is_binary ? take_binary(*node) : take_text();
            if (!content) return content.error();
            if (content->codes == 0) {
                const VoxelCube cube{key_of_morton(node->first), node->height};
                if (!visit(cube, content->log_odds)) return no_room();
                continue;
            }
            if (node->height == 0) return error(MapFault::too_deep, "a node of level 16 has children");
            open_[open_count_++] = {*node, 0, content->codes};
        }
        return std::nullopt;
    }

    /// The next existing child of the innermost open node; closes nodes without further children.
    std::optional<Node> next_node() {
        while (open_count_ > 0) {
            Open& parent = open_[open_count_ - 1];
            while (parent.next < 8) {
                const unsigned child = parent.next++;
                const std::uint32_t code = (parent.codes >> (2 * child)) & 3U;
                const unsigned height = parent.node.height - 1;
                if (code != 0)
                    return Node{parent.node.first + (MortonCode{child} << (3 * height)), height, code};
            }
            --open_count_;
        }
        return std::nullopt;
    }

    /// .ot: each node has a value and a bit for each child.
    Result<Content, MapReadError> take_text() {
        const auto value_bits = take(4);
        position_ += std::min(header_.colour_bytes, bytes_behind());
        const auto children = take(1);
        if (!value_bits || !children) return unexpected(truncated());
        const auto log_odds = std::bit_cast<float>(*value_bits);
        if (auto fault = check(log_odds)) return unexpected(std::move(*fault));
        std::uint32_t codes = 0;
        for (unsigned child = 0; child < 8; ++child) {
            if ((*children & (1U << child)) != 0) codes |= kInner << (2 * child);
        }
        return Content{log_odds, codes};
    }

    /// .bt: an inner node has two bits for each child; a leaf has no bytes, its parent's code describes it.
    Result<Content, MapReadError> take_binary(const Node& node) {
        if (node.code != kInner) {
            return Content{node.code == kFreeLeaf ? config_.log_odds_min : config_.log_odds_max, 0};
        }
        const auto codes = take(2);
        if (!codes) return unexpected(truncated());
        if (*codes == 0)
            return unexpected(error(MapFault::inner_node_empty, "a node with children has none"));
        return Content{0.0F, *codes};
    }

    std::optional<MapReadError> check(float log_odds) const {
        if (!std::isfinite(log_odds))
            return error(MapFault::log_odds_not_finite, "a node's log-odds is not a finite number");
        if (log_odds >= config_.log_odds_min && log_odds <= config_.log_odds_max) return std::nullopt;
        return error(MapFault::log_odds_outside_clamps,
                     fmt::format("log-odds {}, the clamps are {} and {}", log_odds, config_.log_odds_min,
                                 config_.log_odds_max));
    }

    std::string_view bytes_;
    std::size_t position_;
    const OctomapHeader& header_;
    MapConfig config_;
    std::uint64_t nodes_max_ = 0;
    std::uint64_t nodes_ = 0;
    std::array<Open, kOctreeDepth> open_{};  // one for each level whose nodes can have children
    std::size_t open_count_ = 0;
};

/// One sentence for all differences: they rarely matter one by one.
std::vector<std::string> warnings_of(const OctomapHeader& header, const std::string& end) {
    std::vector<std::string> differences = header.differences;
    if (!end.empty()) differences.push_back(end);
    std::vector<std::string> warnings;
    if (!differences.empty()) {
        std::string warning = "not in OctoMap's own form, but read";
        for (const std::string& difference : differences)
            warning += (&difference == differences.data() ? ": " : "; ") + difference;
        warnings.push_back(std::move(warning));
    }
    if (header.colour_bytes > 0) warnings.emplace_back("its voxels' colours are dropped");
    return warnings;
}

}  // namespace

Result<LoadedMap, MapReadError> decode_octomap(std::string_view bytes, const MapReadLimits& limits) {
    const auto header = parse_octomap_header(bytes, limits.nodes_max);
    if (!header) return unexpected(header.error());
    TreeWalk look(bytes, *header, limits);
    const auto look_only = [](const VoxelCube&, float) { return true; };
    if (auto fault = look.walk(look_only)) return unexpected(std::move(*fault));

    MapConfig config = limits.map;
    config.resolution_m = header->resolution_m;
    if (header->occupied_from) config.log_odds_occupied = *header->occupied_from;
    LoadedMap loaded{.map = FusedMap(config),
                     .warnings = warnings_of(*header, look.why_end_differs()),
                     .is_octoskins = header->is_octoskins,
                     .has_lost_colours = header->colour_bytes > 0};
    const auto fill = [&](const VoxelCube& cube, float log_odds) {
        return loaded.map.set_cube(cube, log_odds);
    };
    if (auto fault = TreeWalk(bytes, *header, limits).walk(fill)) return unexpected(std::move(*fault));
    return loaded;
}

}  // namespace octoskin
