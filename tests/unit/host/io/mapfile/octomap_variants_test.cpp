// Files that OctoMap's own reader takes, as other programs write them. Oracle: that reader, of the same
// bytes.
#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTreeStamped.h>
#include <octomap/octomap.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "host/io/mapfile/octomap_reader.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/support/octomap_oracle.hpp"
#include "tests/unit/host/io/mapfile/map_samples.hpp"

namespace octoskin {
namespace {

using Voxels = std::map<VoxelKey, float>;

/// Wider than what any tree here is clamped to.
MapReadLimits wide_limits() {
    MapReadLimits limits;
    limits.map.log_odds_min = -20.0F;
    limits.map.log_odds_max = 20.0F;
    return limits;
}

/// A .bt has no log-odds: what a voxel is, as -1 or 1.
Voxels states_of(const Voxels& voxels) {
    Voxels states;
    for (const auto& [key, log_odds] : voxels) states[key] = log_odds >= 0.0F ? 1.0F : -1.0F;
    return states;
}

struct OctomapsView {
    double resolution_m = 0.0;
    Voxels voxels;
    friend bool operator==(const OctomapsView&, const OctomapsView&) = default;
};

/// What OctoMap makes of a file; empty if nothing. It reports an error of a .bt whose size is wrong, and its
/// tree is there; of one whose size is 0 or missing it reads no node.
std::optional<OctomapsView> octomaps_view(const std::string& bytes) {
    testing::internal::CaptureStderr();
    std::istringstream stream(bytes);
    std::optional<OctomapsView> view;
    if (bytes.starts_with("# Octomap OcTree file")) {
        const std::unique_ptr<octomap::AbstractOcTree> tree(octomap::AbstractOcTree::read(stream));
        const auto look = [&]<class Tree>(const Tree* read) {
            if (read != nullptr) view = {tree->getResolution(), oracle::voxels_of(*read)};
        };
        look(dynamic_cast<const octomap::OcTree*>(tree.get()));
        look(dynamic_cast<const octomap::ColorOcTree*>(tree.get()));
        look(dynamic_cast<const octomap::OcTreeStamped*>(tree.get()));
    } else {
        octomap::OcTree tree(1.0);
        (void)tree.readBinary(stream);
        if (tree.size() > 0) view = {tree.getResolution(), states_of(oracle::voxels_of(tree))};
    }
    testing::internal::GetCapturedStderr();
    return view;
}

OctomapsView our_view(const FusedMap& map, const std::string& bytes) {
    const bool is_text = bytes.starts_with("# Octomap OcTree file");
    const Voxels voxels = oracle::voxels_of(map);
    return {map.resolution_m(), is_text ? voxels : states_of(voxels)};
}

/// The parts of a file that another program may write otherwise.
struct Parts {
    std::string behind_first_line = {};
    std::string line_end = "\n";
    std::string comment = "# a comment";
    std::string id = "id OcTree";
    std::string size = "size @";  ///< @: the right number
    std::string res = "res 0.04";
    std::string behind_last_node = {};
};

/// The nodes of a file that octoskin or OctoMap wrote, under a header of these parts.
std::string with_header(const std::string& file, Parts parts) {
    const std::size_t data = file.find("data\n") + 5;
    const std::size_t size = file.find("size ") + 5;
    const std::string count = file.substr(size, file.find('\n', size) - size);
    if (const auto place = parts.size.find('@'); place != std::string::npos)
        parts.size.replace(place, 1, count);
    std::string bytes = file.substr(0, file.find('\n')) + parts.behind_first_line + parts.line_end;
    for (const std::string& line : {parts.comment, parts.id, parts.size, parts.res, std::string("data")})
        bytes += line + parts.line_end;
    return bytes + file.substr(data) + parts.behind_last_node;
}

void expect_read_as_octomap_reads_it(const std::string& bytes, std::size_t warnings) {
    const std::string shown = bytes.substr(0, std::min<std::size_t>(bytes.find("data"), 300));
    const auto ours = decode_octomap(bytes, wide_limits());
    ASSERT_TRUE(ours) << ours.error().what << "\n" << shown;
    EXPECT_EQ(ours->warnings.size(), warnings) << shown;
    EXPECT_FALSE(ours->is_octoskins);
    const auto octomaps = octomaps_view(bytes);
    ASSERT_TRUE(octomaps) << shown;
    EXPECT_EQ(our_view(ours->map, bytes), *octomaps) << shown;
}

std::vector<std::string> both_formats() {
    return {encode_ot(samples::random_map(7)), encode_bt(samples::random_map(7))};
}

TEST(OctomapVariants, takes_a_header_as_octomap_does_and_warns_of_what_is_odd_in_it) {
    for (const std::string& file : both_formats()) {
        expect_read_as_octomap_reads_it(with_header(file, {}), 0);
        const std::vector<Parts> odd = {
            {.behind_first_line = " of the kitchen"},
            {.line_end = "\r\n"},
            {.line_end = " \n"},
            {.comment = "date 2013-04-01"},
            {.comment = "frame_id: map\nauthor A. U. Thor"},
            {.id = "id 1"},
            {.id = "id  OcTree"},
            {.id = "\tid\tOcTree\t"},
            {.id = "id\nOcTree"},
            {.id = "id ColorOcTree\nid OcTree"},
            {.size = "size 1"},
            {.size = "size 42 "},
            {.size = "size -1"},
            {.size = "size +@"},
            {.size = "size @ nodes"},
            {.res = "res 0.04 "},
            {.res = "res   0.04"},
            {.res = "res 0.04m"},
            {.res = "res +4e-2 # metres"},
            {.res = "res 0.1\nres 0.04"},
            {.behind_last_node = "\n"},
            {.behind_last_node = std::string(5, '\0')},
        };
        for (const Parts& parts : odd) expect_read_as_octomap_reads_it(with_header(file, parts), 1);
        const std::vector<Parts> plain = {
            {.comment = "#"},
            {.comment = "# " + std::string(100'000, 'x')},
            {.comment = "#data"},
            {.id = "# a line of its own\nid OcTree"},
            {.res = "res 4e-2"},
            {.res = "\n\nres 0.04\n"},
            {.res = "res 0.040000000000000001"},
        };
        for (const Parts& parts : plain) expect_read_as_octomap_reads_it(with_header(file, parts), 0);
    }
}

// OctoMap reads no node of a .bt without a size, and takes the count of a .ot for nothing.
TEST(OctomapVariants, reads_a_whole_tree_whose_number_of_nodes_is_missing_or_zero) {
    for (const std::string& file : both_formats()) {
        const auto whole = decode_octomap(file, wide_limits());
        for (const char* size : {"size 0", "# no size"}) {
            const auto read = decode_octomap(with_header(file, {.size = size}), wide_limits());
            ASSERT_TRUE(read) << read.error().what;
            EXPECT_EQ(read->warnings.size(), 1U);
            EXPECT_EQ(oracle::voxels_of(read->map), oracle::voxels_of(whole->map));
        }
    }
}

/// Every combination, of which OctoMap reads all: what we read, we read as it does, and we read all in which
/// the count or the end speaks for the tree.
TEST(OctomapVariants, takes_oddities_together_as_octomap_does) {
    std::size_t read = 0;
    std::size_t refused = 0;
    for (const std::string& file : {encode_ot(samples::small_map()), encode_bt(samples::small_map())}) {
        for (const char* behind : {"", "\t2"}) {
            for (const char* line_end : {"\n", "\r\n", " \n"}) {
                for (const char* comment : {"#", "author size 7", "data_type OcTree"}) {
                    for (const char* id : {"id OcTree", "id 1", "  id   OcTree"}) {
                        for (const char* size : {"size @", "size 3", "size -2"}) {
                            for (const char* res : {"res 0.04", "res 4e-2 5", "res 1 # no\n res .04"}) {
                                for (const char* tail : {"", "\n\n"}) {
                                    const std::string bytes =
                                        with_header(file, {behind, line_end, comment, id, size, res, tail});
                                    const bool is_sure = *tail == '\0' || std::string(size) == "size @";
                                    const auto ours = decode_octomap(bytes, wide_limits());
                                    ASSERT_EQ(ours.has_value(), is_sure) << bytes.substr(0, 200);
                                    ++(ours ? read : refused);
                                    if (!ours) continue;
                                    ASSERT_EQ(our_view(ours->map, bytes), octomaps_view(bytes))
                                        << bytes.substr(0, 200);
                                }
                            }
                        }
                    }
                }
            }
        }
    }
    EXPECT_EQ(read, 1296U);
    EXPECT_EQ(refused, 648U);
}

TEST(OctomapVariants, refuses_every_oddity_in_a_map_that_octoskin_saved) {
    const std::string mark = "# saved by octoskin";
    for (const std::string& file : both_formats()) {
        EXPECT_TRUE(decode_octomap(file, {})->is_octoskins);
        const std::vector<Parts> mended = {
            {.comment = mark + "\n# of the kitchen"},
            {.comment = mark, .res = "res 0.040"},
        };
        for (const Parts& parts : mended) {
            const auto read = decode_octomap(with_header(file, parts), {});
            ASSERT_TRUE(read) << read.error().what;
            EXPECT_TRUE(read->is_octoskins);
        }
        const std::vector<Parts> odd = {
            {.behind_first_line = " of the kitchen", .comment = mark},
            {.line_end = "\r\n", .comment = mark},
            {.comment = mark + "\nauthor A. U. Thor"},
            {.comment = mark, .id = "id 1"},
            {.comment = mark, .id = "id ColorOcTree"},
            {.comment = mark, .size = "size 1"},
            {.comment = mark, .size = "size 0"},
            {.comment = mark, .size = "#"},
            {.comment = mark, .res = "res 0.04 "},
            {.comment = mark, .res = "res 0.04\nres 0.04"},
            {.comment = mark, .behind_last_node = "\n"},
        };
        for (const Parts& parts : odd)
            EXPECT_FALSE(decode_octomap(with_header(file, parts), {}))
                << with_header(file, parts).substr(0, 200);
    }
}

/// Two coloured or stamped voxels and a pruned cube of them, as OctoMap holds them.
template <class Tree>
void fill(Tree& tree) {
    for (int i = 0; i < 64; ++i) {
        const octomap::OcTreeKey key(static_cast<std::uint16_t>(32768 + i % 4),
                                     static_cast<std::uint16_t>(32768 + i / 4 % 4),
                                     static_cast<std::uint16_t>(32768 + i / 16));
        for (int times = 0; times < 9; ++times) tree.updateNode(key, i % 7 != 0);
    }
    tree.updateNode(octomap::OcTreeKey(31000, 33000, 32768), false);
    if constexpr (std::is_same_v<Tree, octomap::ColorOcTree>) {
        for (int i = 0; i < 64; ++i) {
            tree.setNodeColor(octomap::OcTreeKey(static_cast<std::uint16_t>(32768 + i % 4),
                                                 static_cast<std::uint16_t>(32768 + i / 4 % 4), 32768),
                              static_cast<std::uint8_t>(i), 255, 13);
        }
    }
}

template <class Tree>
std::string text_file_of() {
    Tree tree(0.04);
    fill(tree);
    std::ostringstream text;
    EXPECT_TRUE(tree.write(text));
    return text.str();
}

template <class Tree>
std::string binary_file_of() {
    Tree tree(0.04);
    fill(tree);
    std::ostringstream binary;
    EXPECT_TRUE(tree.writeBinary(binary));
    return binary.str();
}

TEST(OctomapVariants, reads_trees_with_colours_and_stamps) {
    expect_read_as_octomap_reads_it(binary_file_of<octomap::ColorOcTree>(), 0);
    expect_read_as_octomap_reads_it(binary_file_of<octomap::OcTreeStamped>(), 0);
    expect_read_as_octomap_reads_it(text_file_of<octomap::OcTreeStamped>(), 0);
    const std::string coloured = text_file_of<octomap::ColorOcTree>();
    expect_read_as_octomap_reads_it(coloured, 1);
    EXPECT_TRUE(decode_octomap(coloured, wide_limits())->has_lost_colours);
    EXPECT_FALSE(decode_octomap(text_file_of<octomap::OcTree>(), wide_limits())->has_lost_colours);
    for (std::size_t length = coloured.find("data") + 5; length < coloured.size(); ++length)
        ASSERT_FALSE(decode_octomap(coloured.substr(0, length), wide_limits())) << length;
}

// Every tree of occupancies has the same .bt; what else is in a .ot depends on its type.
TEST(OctomapVariants, reads_an_unknown_tree_of_a_bt_and_no_other) {
    const FusedMap map = samples::random_map(2);
    expect_read_as_octomap_reads_it(with_header(encode_bt(map), {.id = "id SemanticOcTree"}), 1);
    for (const char* id : {"id SemanticOcTree", "id CountingOcTree", "id OcTrees", "id octree"}) {
        const auto refused = decode_octomap(with_header(encode_ot(map), {.id = id}), {});
        ASSERT_FALSE(refused) << id;
        EXPECT_EQ(refused.error().fault, MapFault::wrong_tree_type);
    }
}

std::string little_endian(std::uint64_t value, unsigned count) {
    std::string bytes;
    for (unsigned i = 0; i < count; ++i) bytes.push_back(static_cast<char>((value >> (8 * i)) & 0xFFU));
    return bytes;
}

/// The format before OctoMap 1.4: type, resolution and count as binary numbers.
std::string before_1_4(double resolution_m, std::uint32_t nodes, const std::string& tree) {
    return little_endian(3, 4) + little_endian(std::bit_cast<std::uint64_t>(resolution_m), 8) +
           little_endian(nodes, 4) + tree;
}

TEST(OctomapVariants, reads_the_format_before_1_4) {
    const std::string file = encode_bt(samples::random_map(4));
    const std::string tree = file.substr(file.find("data\n") + 5);
    const auto nodes = static_cast<std::uint32_t>(std::stoul(file.substr(file.find("size ") + 5)));
    const std::string old = before_1_4(0.05, nodes, tree);
    expect_read_as_octomap_reads_it(old, 1);
    EXPECT_EQ(decode_octomap(old, {})->map.resolution_m(), 0.05);
    EXPECT_TRUE(decode_octomap(before_1_4(0.05, 0, ""), {})) << "an empty tree";
    for (std::size_t length = 0; length < old.size(); ++length)
        ASSERT_FALSE(decode_octomap(old.substr(0, length), {})) << length;
    for (const double resolution_m : {0.0, -0.05, 1e9, std::nan("")}) {
        const auto refused = decode_octomap(before_1_4(resolution_m, nodes, tree), {});
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().fault, MapFault::resolution_not_valid);
    }
}

}  // namespace
}  // namespace octoskin
