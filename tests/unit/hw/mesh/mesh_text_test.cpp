#include "hw/mesh/mesh_text.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/hw/mesh/shape_files.hpp"

namespace octoskin {
namespace {

const std::string kFacet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";

TEST(MeshText, counts_the_triangles_of_stl_and_obj) {
    EXPECT_EQ(check_mesh_text(".stl", testing_support::wedge_stl())->triangles, 4U);
    EXPECT_EQ(check_mesh_text(".STL", testing_support::wedge_ascii_stl())->triangles, 4U);
    EXPECT_EQ(check_mesh_text(".obj", testing_support::wedge_obj())->triangles, 4U);
    EXPECT_EQ(check_mesh_text(".dae", testing_support::wedge_dae("Z_UP", 0.001))->triangles, std::nullopt);
    EXPECT_EQ(
        check_mesh_text(".stl", "solid a b\n" + kFacet + "endsolid\n\nsolid\n" + kFacet + kFacet + "endsolid")
            ->triangles,
        3U);
    EXPECT_EQ(check_mesh_text(".obj", "v 0 0 0\nv 1 0 0 # b\nv 0 1 0 1\nv 1 1 0 .5 .5 .5\n").has_value(),
              false);
    EXPECT_EQ(
        check_mesh_text(".obj", "v 0 -1e-3 +0.5\nf 1 2 3 4 # quad\nf 1/2/3 2//1 3\nl 1 2\np 1\n")->triangles,
        3U);
}

TEST(MeshText, refuses_an_stl_text_that_a_reader_would_take_in_part) {
    const std::string whole = "solid a\n" + kFacet + kFacet + "endsolid a\n";
    ASSERT_TRUE(check_mesh_text(".stl", whole));
    for (const std::string& wrong :
         {"solid a\n" + kFacet, whole + kFacet, whole + "SOLID b\n" + kFacet, whole + "comment\n",
          whole + std::string(1, '\0'),
          std::string("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
                      "0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n")})
        EXPECT_FALSE(check_mesh_text(".stl", wrong)) << wrong;
    for (std::size_t length = 0; length + 12 < whole.size(); ++length)
        EXPECT_FALSE(check_mesh_text(".stl", whole.substr(0, length))) << length;
    const std::string binary = testing_support::wedge_stl();
    for (std::size_t length = 0; length < binary.size(); ++length)
        EXPECT_FALSE(check_mesh_text(".stl", binary.substr(0, length))) << length;
}

TEST(MeshText, refuses_an_obj_whose_vertices_a_reader_would_leave_out) {
    for (const char* wrong : {"v 0 0", "v 0 0 0 1 1", "v 0 0 0 1 1 1 1", "v .5 0 0", "v 0 -.5 0", "v 0 0 nan",
                              "v 0 0 1x", "V 0 0 0", "F 1 2 3", "f 1 2", "f", "v 0 0 \\\n0"})
        EXPECT_FALSE(check_mesh_text(".obj", wrong)) << wrong;
    EXPECT_FALSE(check_mesh_text(".obj", std::string_view("v 0 0 0\n\0", 9)));
}

TEST(MeshText, refuses_a_collada_file_of_which_a_part_is_elsewhere) {
    const auto with = [](const std::string& content) {
        return check_mesh_text(".dae", "<COLLADA><asset/><library_nodes><node id=\"n\">" + content +
                                           "</node></library_nodes></COLLADA>");
    };
    EXPECT_TRUE(with("<instance_node url=\"#n\"/><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>"));
    for (const char* wrong :
         {"<instance_node url=\"other.dae#n\"/>", "<instance_node url=\"#m\"/>", "<instance_geometry/>",
          "<instance_controller url=\"n\"/>", "<unit meter=\"-1\"/>", "<unit meter=\"abc\"/>",
          "<unit meter=\"0\"/>", "<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2</matrix>", "<matrix>1</matrix>",
          "<p>0 1 -1</p>"})
        EXPECT_FALSE(with(wrong)) << wrong;
    EXPECT_FALSE(check_mesh_text(".dae", "<COLLADA>"));
    EXPECT_FALSE(check_mesh_text(".dae", ""));
}

}  // namespace
}  // namespace octoskin
