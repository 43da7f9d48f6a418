// What a reader hands over arrives bit for bit, or is refused whole.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>

#include "hw/sim/world/solids_bytes.hpp"

namespace octoskin::sim {
namespace {

std::vector<Solid> two_solids() {
    Solid odd{"a/b/c", "a", {}, {}, false};
    odd.vertices = {{-0.0, 0.1, 1e-310}, {1e300, -1.0 / 3.0, std::numeric_limits<double>::epsilon()}};
    odd.triangles = {{0, 1, 0}, {1, 1, 1}};
    return {odd, {"", "", {}, {}, true}};
}

void expect_equal(const Solid& a, const Solid& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.model, b.model);
    EXPECT_EQ(a.is_closed, b.is_closed);
    EXPECT_EQ(a.triangles, b.triangles);
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    for (std::size_t i = 0; i < a.vertices.size(); ++i) {
        for (int k = 0; k < 3; ++k)
            EXPECT_EQ(std::bit_cast<std::uint64_t>(a.vertices[i][k]),
                      std::bit_cast<std::uint64_t>(b.vertices[i][k]));
    }
}

TEST(SolidsBytes, bring_every_bit_of_the_solids) {
    const auto solids = two_solids();
    const auto again = from_bytes(to_bytes(SolidsOfFile{solids, {"one", ""}, "<sdf/>", {"a.stl", "b.obj"}}));
    ASSERT_TRUE(again && *again);
    EXPECT_EQ((*again)->warnings, (std::vector<std::string>{"one", ""}));
    EXPECT_EQ((*again)->written_out, "<sdf/>");
    EXPECT_EQ((*again)->meshes, (std::vector<std::string>{"a.stl", "b.obj"}));
    ASSERT_EQ((*again)->solids.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) expect_equal((*again)->solids[i], solids[i]);
}

TEST(SolidsBytes, bring_an_error_without_its_file) {
    const auto again = from_bytes(to_bytes(
        unexpected(Error{ErrorCode::unsupported, "what\n", "value", "remedy", "x.sdf", 0, 0, "model 'm'"})));
    ASSERT_TRUE(again);
    ASSERT_FALSE(*again);
    EXPECT_EQ(again->error().file, "");
    EXPECT_EQ(again->error().code, ErrorCode::unsupported);
    EXPECT_EQ(again->error().key, "model 'm'");
    EXPECT_EQ(again->error().what, "what\n");
    EXPECT_EQ(again->error().value, "value");
    EXPECT_EQ(again->error().remedy, "remedy");
}

TEST(SolidsBytes, that_are_cut_off_or_go_on_are_refused) {
    for (const std::string& whole :
         {to_bytes(SolidsOfFile{two_solids()}),
          to_bytes(unexpected(Error{.what = "what", .value = "value", .key = "element"}))}) {
        for (std::size_t size = 0; size < whole.size(); ++size)
            EXPECT_FALSE(from_bytes(std::string_view(whole).substr(0, size))) << size;
        EXPECT_FALSE(from_bytes(whole + '\0'));
    }
}

TEST(SolidsBytes, with_counts_beyond_their_end_are_refused_without_making_room) {
    const std::string whole = to_bytes(SolidsOfFile{two_solids()});
    for (std::size_t at = 0; at + 8 <= whole.size(); ++at) {
        std::string changed = whole;
        for (std::size_t i = 0; i < 8; ++i) changed[at + i] = '\xff';
        (void)from_bytes(changed);  // no crash, no allocation beyond the bytes: the sanitizers watch
    }
    const std::string beginning = whole.substr(0, whole.find('\n') + 2);
    const std::string many = std::string(7, '\xff') + '\x7f';
    EXPECT_FALSE(from_bytes(beginning + many)) << "of warnings";
    EXPECT_FALSE(from_bytes(beginning + std::string(8, '\0') + many)) << "of solids";
}

TEST(SolidsBytes, with_a_corner_that_is_no_vertex_are_refused) {
    for (const int corner : {2, -1, std::numeric_limits<int>::max()}) {
        auto solids = two_solids();
        solids[0].triangles[1][2] = corner;
        EXPECT_FALSE(from_bytes(to_bytes(SolidsOfFile{solids}))) << corner;
    }
}

}  // namespace
}  // namespace octoskin::sim
