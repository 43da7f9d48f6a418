// A .ot or .bt map: what our reader accepts, OctoMap's reader understands the same way, and our writers
// bring back. OctoMap may refuse what ours warns of.
#include <octomap/ColorOcTree.h>
#include <octomap/OcTreeStamped.h>
#include <octomap/octomap.h>

#include <cassert>
#include <memory>
#include <sstream>

#include "host/io/mapfile/octomap_reader.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin {
namespace {

MapReadLimits limits() {
    MapReadLimits limits;
    limits.map.memory_max_mib = 4;
    limits.nodes_max = 100'000;
    return limits;
}

bool is_text(std::string_view bytes) {
    return bytes.starts_with("# Octomap OcTree file");
}

/// Of a .bt whose header gives another number of nodes OctoMap reports an error, and the tree is there.
std::unique_ptr<octomap::AbstractOcTree> read_with_octomap(std::string_view bytes) {
    std::istringstream stream{std::string(bytes)};
    if (is_text(bytes))
        return std::unique_ptr<octomap::AbstractOcTree>(octomap::AbstractOcTree::read(stream));
    auto tree = std::make_unique<octomap::OcTree>(1.0);
    const bool is_as_said = tree->readBinary(stream);
    if (!is_as_said && tree->size() == 0) return nullptr;
    return tree;
}

/// The oracle: every leaf of OctoMap's tree, at its lowest and highest voxel.
template <class Tree>
void compare_voxels(const FusedMap& map, const Tree& tree, bool is_binary) {
    std::size_t voxels = 0;
    for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
        const unsigned height = tree.getTreeDepth() - leaf.getDepth();
        voxels += std::size_t{1} << (3 * height);
        const octomap::OcTreeKey lowest = leaf.getIndexKey();
        const auto last = static_cast<std::uint16_t>((1U << height) - 1);
        const VoxelKey ends[] = {
            {lowest[0], lowest[1], lowest[2]},
            {static_cast<std::uint16_t>(lowest[0] + last), static_cast<std::uint16_t>(lowest[1] + last),
             static_cast<std::uint16_t>(lowest[2] + last)}};
        for (const VoxelKey& key : ends) {
            const auto log_odds = map.log_odds(key);
            assert(log_odds);
            assert(is_binary ? (*log_odds > 0.0F) == tree.isNodeOccupied(*leaf)
                             : *log_odds == leaf->getLogOdds());
        }
    }
    assert(voxels == map.known_voxels());
}

void compare_with_octomap(const LoadedMap& loaded, std::string_view bytes) {
    const auto tree = read_with_octomap(bytes);
    const bool is_warned_of = !loaded.warnings.empty();
    assert(tree || is_warned_of);
    if (!tree || (is_warned_of && tree->size() == 0)) return;  // it takes a size of 0 at its word
    if (const auto* const plain = dynamic_cast<const octomap::OcTree*>(tree.get()))
        return compare_voxels(loaded.map, *plain, !is_text(bytes));
    if (const auto* const stamped = dynamic_cast<const octomap::OcTreeStamped*>(tree.get()))
        return compare_voxels(loaded.map, *stamped, false);
    const auto* const coloured = dynamic_cast<const octomap::ColorOcTree*>(tree.get());
    assert(coloured);
    compare_voxels(loaded.map, *coloured, false);
}

void check_written(const FusedMap& map) {
    const std::string ot = encode_ot(map);
    MapReadLimits ours = limits();
    ours.map.memory_max_mib = 8;  // the same voxels in another order may need more room
    const auto from_ot = decode_octomap(ot, ours);
    assert(from_ot && from_ot->map.known_voxels() == map.known_voxels());
    assert(encode_ot(from_ot->map) == ot);
    const std::string bt = encode_bt(map);
    const auto from_bt = decode_octomap(bt, ours);
    assert(from_bt && from_bt->map.known_voxels() == map.known_voxels());
    assert(encode_bt(from_bt->map) == bt);
}

}  // namespace
}  // namespace octoskin

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes = octoskin::fuzz::text_of({data, size});
    const auto map = octoskin::decode_octomap(bytes, octoskin::limits());
    if (!map) {
        assert(!map.error().what.empty());
        return 0;
    }
    octoskin::compare_with_octomap(*map, bytes);
    octoskin::check_written(map->map);
    return 0;
}
