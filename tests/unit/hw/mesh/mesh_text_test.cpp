#include "hw/mesh/mesh_text.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/unit/hw/mesh/shape_files.hpp"

namespace octoskin {
namespace {

const std::string kFacet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";

TEST(MeshText, counts_the_triangles_of_stl_and_obj) {
    EXPECT_EQ(check_mesh_text(".stl", testing_support::wedge_stl())->triangles, 4U);
    EXPECT_EQ(check_mesh_text(".STL", testing_support::wedge_ascii_stl())->triangles, 4U);
    EXPECT_EQ(check_mesh_text(".obj", testing_support::wedge_obj())->triangles, 4U);
    EXPECT_EQ(check_mesh_text(".dae", testing_support::wedge_dae("Z_UP", 0.001))->triangles, 4U);
    EXPECT_EQ(check_mesh_text(".stl", "solid facet vertices\n" + kFacet + "endsolid\n\nsolid\n" + kFacet +
                                          kFacet + "endsolid")
                  ->triangles,
              3U);
    EXPECT_EQ(check_mesh_text(".obj", "v 0 0 0\nv 1 0 0 # b\nv 0 1 0 1\nv 1 1 0 .5 .5 .5\n").has_value(),
              false);
    EXPECT_EQ(
        check_mesh_text(".obj",
                        "v 0 -1e-3 +0.5\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf 1/2/3 2//1 3\nl 1 2\np 1\n")
            ->triangles,
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
    for (const char* corner : {"vertex 1 0", "vertex 1 0 0 0", "vertex 1 0 0 vertex", "vertex 1 0-0 0",
                               "vertex 0..0 0.5 0", "vertex 1 0 0x2", "vertex 1 0 nan",
                               "vertex 0 0 50000000000000000000e-20", "vertex 1 0 0.00000000000000005e17"}) {
        std::string text = whole;
        text.replace(text.find("vertex 1 0 0"), 12, corner);
        EXPECT_FALSE(check_mesh_text(".stl", text)) << corner;
    }
    for (const auto& [from, to] :
         {std::pair{"outer loop", "outer vertex 0 0 0"}, std::pair{"outer loop", "outer"},
          std::pair{"outer loop", "outer loop vertex 0 0 0"}, std::pair{"endloop", "endloop vertex 0 0 0"},
          std::pair{"endfacet", "endfacet facet"}, std::pair{"normal 0 0 1", "normal 0 0 1 vertex 0 0 0"},
          std::pair{"normal 0 0 1", "normal 0 0 1vertex 0 0 0"}, std::pair{"normal 0 0 1", "0 0 1"},
          std::pair{"solid a", "solid a endsolid"}, std::pair{"solid a", "solid a vertex 0 0 0"}}) {
        std::string text = whole;
        text.replace(text.find(from), std::string(from).size(), to);
        EXPECT_FALSE(check_mesh_text(".stl", text)) << to;
    }
    for (const char* normal : {"normal nan -nan inf", "normal -nan(ind) 1e-3 .5"}) {
        std::string text = whole;
        text.replace(text.find("normal 0 0 1"), 12, normal);
        EXPECT_TRUE(check_mesh_text(".stl", text)) << normal;
    }
    for (std::size_t length = 0; length + 12 < whole.size(); ++length)
        EXPECT_FALSE(check_mesh_text(".stl", whole.substr(0, length))) << length;
    const std::string binary = testing_support::wedge_stl();
    for (std::size_t length = 0; length < binary.size(); ++length)
        EXPECT_FALSE(check_mesh_text(".stl", binary.substr(0, length))) << length;
}

TEST(MeshText, refuses_an_obj_whose_vertices_a_reader_would_leave_out) {
    for (const char* wrong : {"v 0 0",
                              "v 0 0 0 1 1",
                              "v 0 0 0 1 1 1 1",
                              "v .5 0 0",
                              "v 0 -.5 0",
                              "v 0 0 nan",
                              "v 0 0 1x",
                              "V 0 0 0",
                              "F 1 2 3",
                              "f 1 2",
                              "f",
                              "v 0 0 \\\n0",
                              "v 0 0 0.5 # corner 2 of 2",
                              "v 0 0 0 # -a",
                              "v 0 0 0 # NaN",
                              "f 1 2 3",
                              "v 0 0 0\nf 1 1 -2",
                              "f a b c",
                              "f 0 0 0",
                              "f 1 2 3 # a",
                              "f 1 2 3 # 4",
                              " v 0 0 0",
                              "\tf 1 2 3",
                              "# a\rv 0 0 0\n",
                              "\xEF\xBB\xBFv 0 0 0",
                              "surf 0 1 0 1 1 2",
                              "curv 0 1 1 2",
                              "curv2 1 2",
                              "parm u 0 1",
                              "trim 0 1 1",
                              "hole 0 1 1",
                              "cstype bezier",
                              "v 0 0 50000000000000000000e-20",
                              "v 0 0 0.00000000000000005e17"})
        EXPECT_FALSE(check_mesh_text(".obj", wrong)) << wrong;
    for (const char* right : {"v 0 0 0 # a corner\r\n", "v 0 0 0 #1", "# 1 2 3\nv 0 0 0", "vn 0 0 1 # 2",
                              "v 0 0 123456789012345"})
        EXPECT_TRUE(check_mesh_text(".obj", right)) << right;
    EXPECT_FALSE(check_mesh_text(".obj", std::string_view("v 0 0 0\n\0", 9)));
}

TEST(MeshText, has_the_box_of_the_corners_of_an_obj) {
    const auto text = check_mesh_text(
        ".obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nf -2 -1 4\nv 0 4 6 2\nv -5 0 0 1 1 1\nf 2/1/1 3//1 4/2\n");
    ASSERT_TRUE(text) << text.error();
    ASSERT_TRUE(text->box);
    EXPECT_TRUE(text->box->isApprox(Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d(1, 2, 3))));
}

TEST(MeshText, refuses_a_collada_file_of_which_a_part_is_elsewhere) {
    const auto with = [](const std::string& content) {
        return check_mesh_text(".dae", "<COLLADA><asset/><library_nodes><node id=\"n\">" + content +
                                           "</node></library_nodes></COLLADA>");
    };
    const std::string node = "<instance_node url=\"#n\"/>";
    EXPECT_TRUE(with(node + "<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>"));
    for (const char* wrong :
         {"<instance_node url=\"other.dae#n\"/>", "<instance_node url=\"#m\"/>", "<instance_geometry/>",
          "<instance_controller url=\"n\"/>", "<unit meter=\"-1\"/>", "<unit meter=\"abc\"/>",
          "<unit meter=\"0x1\"/>", "<unit meter=\"0\"/>", "<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2</matrix>",
          "<matrix>1</matrix>"})
        EXPECT_FALSE(with(node + wrong)) << wrong;
    EXPECT_FALSE(check_mesh_text(".dae", "<COLLADA>"));
    EXPECT_FALSE(check_mesh_text(".dae", ""));
}

/// The wedge's file with `from` replaced by `to`, at its first place.
Result<MeshText, std::string> check_wedge(const std::string& from, const std::string& to) {
    std::string text = testing_support::wedge_dae("Z_UP", 1.0, "<translate>0 0 1</translate>");
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return check_mesh_text(".dae", text.replace(at, from.size(), to));
}

const std::string kParams =
    "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/>";
const std::string kNode = "<instance_geometry url=\"#wedge\"/>";
const std::string kMove = "<translate>0 0 1</translate>";

TEST(MeshText, counts_the_triangles_of_all_instances_of_collada) {
    EXPECT_EQ(check_wedge(kNode, kNode)->triangles, 4U);
    EXPECT_EQ(check_wedge(kNode, kNode + kNode)->triangles, 8U);
    EXPECT_EQ(check_wedge(kNode, "<extra><technique>" + kNode + "</technique></extra>")->triangles, 0U);
    EXPECT_EQ(
        check_wedge("<library_visual_scenes>", "<library_nodes><node id=\"n\"><node>" + kNode +
                                                   "</node></node></library_nodes><library_visual_scenes>")
            ->triangles,
        4U);
    const auto twice = check_mesh_text(".dae", [] {
        std::string text = testing_support::wedge_dae("Z_UP", 1.0);
        text.insert(text.find("<library_visual_scenes>"),
                    "<library_nodes><node id=\"n\">" + kNode + kNode + "</node></library_nodes>");
        return text.insert(text.find("</visual_scene>"), "<node><instance_node url=\"#n\"/></node>");
    }());
    ASSERT_TRUE(twice) << twice.error();
    EXPECT_EQ(twice->triangles, 12U);
}

TEST(MeshText, refuses_instances_of_nodes_in_each_other) {
    std::string text = testing_support::wedge_dae("Z_UP", 1.0);
    text.insert(text.find("<library_visual_scenes>"),
                "<library_nodes><node id=\"n\"><instance_node url=\"#n\"/></node></library_nodes>");
    text.insert(text.find("</visual_scene>"), "<node><instance_node url=\"#n\"/></node>");
    EXPECT_FALSE(check_mesh_text(".dae", text));
}

TEST(MeshText, refuses_surfaces_of_collada_that_a_reader_would_leave_out) {
    const std::string mesh = "<geometry id=\"wedge\">";
    for (const auto& [from, to] :
         {std::pair{mesh, mesh + "<convex_mesh convex_hull_of=\"#wedge\"/>"},
          std::pair{std::string("<triangles"),
                    std::string("<trifans count=\"1\"><p>0 1 2</p></trifans><triangles")},
          std::pair{std::string("<triangles count=\"4\""), std::string("<triangles count=\"0\"")},
          std::pair{std::string("<triangles count=\"4\""), std::string("<triangles")},
          std::pair{std::string("<triangles count=\"4\""), std::string("<triangles count=\"0x4\"")},
          std::pair{std::string("<p>0 "), std::string("<p>-0 ")},
          std::pair{std::string("<p>0 "), std::string("<p>0,")},
          std::pair{std::string("<p>0 "), std::string("<p>4294967296 ")},
          std::pair{std::string("<p>0 "), std::string("<p><!-- first -->0 ")},
          std::pair{std::string("<p>0 "), std::string("<p>0 <!-- second --> ")},
          std::pair{std::string("<node id=\"inner\">"), "<x:node>" + kNode + "</x:node><node id=\"inner\">"}})
        EXPECT_FALSE(check_wedge(from, to)) << to;
}

TEST(MeshText, takes_collada_with_surfaces_that_are_not_in_the_scene) {
    const std::string geometries = "<library_geometries>";
    const auto text = check_wedge(
        geometries, geometries + "<geometry id=\"hull\"><convex_mesh convex_hull_of=\"#wedge\"/></geometry>");
    ASSERT_TRUE(text) << text.error();
    EXPECT_EQ(text->triangles, 4U);
}

TEST(MeshText, takes_skins_of_collada_that_leave_the_shape_as_it_is) {
    const std::string geometries = "<library_geometries>";
    const auto check_skin = [&](const std::string& content) {
        std::string text = testing_support::wedge_dae("Z_UP", 1.0);
        text.replace(text.find(kNode), kNode.size(), "<instance_controller url=\"#c\"/>");
        return check_mesh_text(
            ".dae", text.insert(text.find(geometries), "<library_controllers><controller id=\"c\">" +
                                                           content + "</controller></library_controllers>"));
    };
    const auto whole = check_skin(
        "<skin source=\"#wedge\"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 "
        "1</bind_shape_matrix></skin>");
    ASSERT_TRUE(whole) << whole.error();
    EXPECT_EQ(whole->triangles, 4U);
    for (const char* wrong : {"", "<skin source=\"#corners\"/>", "<morph source=\"#wedge\"/>",
                              "<skin source=\"#wedge\"><bind_shape_matrix>1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 "
                              "1</bind_shape_matrix></skin>"})
        EXPECT_FALSE(check_skin(wrong)) << wrong;
}

TEST(MeshText, refuses_corners_of_collada_that_a_reader_would_misplace) {
    const std::string param = "<param name=\"X\"";
    const std::string array = "<float_array id=\"numbers\" count=\"12\">";
    for (const auto& [from, to] :
         {std::pair{param, std::string("<param name=\"x\"")}, std::pair{param, std::string("<param")},
          std::pair{param, std::string("<param name=\"Y\"")}, std::pair{array + "0 ", array + "0x2 "},
          std::pair{array + "0 ", array + "1.2.3 "}, std::pair{array + "0 ", array + "5-0 "},
          std::pair{array, array + "<!-- corners -->"}, std::pair{array, array + "0 "},
          std::pair{std::string("<p>0 "), std::string("<p>4 ")},
          std::pair{std::string("count=\"12\""), std::string("count=\"11\"")},
          std::pair{std::string("stride=\"3\""), std::string("stride=\"4\"")},
          std::pair{std::string("<source id"),
                    "<source id=\"corners\">" + array + "</float_array></source><source id"},
          std::pair{std::string("\"POSITION\""), std::string("\"position\"")}})
        EXPECT_FALSE(check_wedge(from, to)) << to;
}

TEST(MeshText, refuses_transforms_of_collada_that_a_reader_would_misread) {
    EXPECT_TRUE(check_wedge(kMove, kMove + "<rotate>0 0 0 0</rotate><rotate>0.6 0.8 0 20</rotate>"));
    for (const char* wrong :
         {"<translate>0 0</translate>", "<translate>0 0 0 1</translate>", "<translate>0 0 1..0</translate>",
          "<translate>0 0<!-- up --> 1</translate>", "<scale>1 1 1-1</scale>", "<rotate>0 0 0.5 90</rotate>",
          "<rotate>0 0 0.999 90</rotate>", "<rotate>0 0 1 90 1</rotate>", "<skew>45 1 0 0 0 1 0</skew>",
          "<lookat>0 0 5 0 0 0 0 1 0</lookat>", "<matrix>1 0 0 0</matrix>",
          "<translate>0 0 50000000000000000000e-20</translate>"})
        EXPECT_FALSE(check_wedge(kMove, wrong)) << wrong;
    EXPECT_TRUE(check_wedge(kMove, "<node><rotate>0 0 0.5 90</rotate><instance_light url=\"#l\"/></node>"))
        << "a light has no surface";
}

TEST(MeshText, refuses_instances_in_collada_of_elements_of_another_kind_or_of_several) {
    const std::string geometry = "<library_geometries><geometry id=\"wedge\">";
    for (const char* wrong : {"<instance_geometry url=\"#corners\"/>", "<instance_geometry url=\"#inner\"/>",
                              "<instance_controller url=\"#wedge\"/>", "<instance_node url=\"#wedge\"/>",
                              "<instance_node url=\"#scene\"/>"})
        EXPECT_FALSE(check_wedge(kNode, wrong)) << wrong;
    EXPECT_FALSE(
        check_wedge(geometry, "<library_geometries><geometry id=\"wedge\"/><geometry id=\"wedge\">"));
    EXPECT_FALSE(
        check_wedge("<instance_visual_scene url=\"#scene\"", "<instance_visual_scene url=\"#outer\""));
    const std::string libraries = "<library_nodes><node id=\"n\"/>";
    const std::string instance =
        "<library_visual_scenes><visual_scene id=\"scene\"><node><instance_node url=\"#n\"/></node>";
    const std::string scene = "<library_visual_scenes><visual_scene id=\"scene\">";
    EXPECT_TRUE(check_wedge(scene, libraries + "</library_nodes>" + instance));
    EXPECT_FALSE(check_wedge(scene, libraries + "<node id=\"n\"/></library_nodes>" + instance));
}

TEST(MeshText, refuses_two_instances_of_collada_whose_materials_a_reader_mixes_up) {
    const auto instance = [](const std::string& a, const std::string& b) {
        return "<instance_geometry url=\"#wedge\"><bind_material><technique_common><instance_material "
               "symbol=\"a\" "
               "target=\"#" +
               a + "\"/><instance_material symbol=\"b\" target=\"#" + b +
               "\"/></technique_common></bind_material></instance_geometry>";
    };
    const auto check_two = [&](const std::string& first, const std::string& second) {
        std::string text = testing_support::wedge_dae("Z_UP", 1.0);
        text.replace(text.find(kNode), kNode.size(), first + second);
        text.replace(text.find("<triangles"), 10, "<triangles material=\"a\"");
        return check_mesh_text(".dae",
                               text.insert(text.find("</mesh>"),
                                           "<triangles material=\"b\" count=\"1\"><input semantic=\"VERTEX\" "
                                           "source=\"#vertices\" offset=\"0\"/><p>0 1 2</p></triangles>"));
    };
    EXPECT_TRUE(check_two(instance("red", "green"), instance("red", "green")));
    EXPECT_TRUE(check_two(instance("red", "green"), instance("blue", "white")));
    EXPECT_FALSE(check_two(instance("red", "green"), instance("red", "blue")));
}

}  // namespace
}  // namespace octoskin
