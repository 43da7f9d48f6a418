// Oracle: the corners that the files were written from, and python3-collada, which is not assimp.
#include "hw/mesh/mesh_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/hw/mesh/shape_files.hpp"

namespace octoskin {
namespace {

using Eigen::Vector3d;
using testing_support::kWedge;
using testing_support::kWedgeFaces;
using testing_support::ScratchFolder;

using Corners = std::vector<Vector3d>;

/// The corners of all triangles, in an order that does not depend on the file's.
Corners sorted(Corners corners) {
    std::ranges::sort(corners, [](const Vector3d& left, const Vector3d& right) {
        constexpr double kSame_m = 1e-5;
        for (int axis = 0; axis < 3; ++axis)
            if (std::abs(left[axis] - right[axis]) > kSame_m) return left[axis] < right[axis];
        return false;
    });
    return corners;
}

Corners corners_of(const TriangleMesh& mesh) {
    Corners corners;
    for (const auto& triangle : mesh.triangles)
        for (int i = 0; i < 3; ++i) corners.push_back(mesh.vertices[static_cast<std::size_t>(triangle[i])]);
    return sorted(corners);
}

Corners wedge_moved(const std::function<Vector3d(const Vector3d&)>& move) {
    Corners corners;
    for (const auto& face : kWedgeFaces)
        for (const int corner : face) corners.push_back(move(kWedge[static_cast<std::size_t>(corner)]));
    return sorted(corners);
}

void expect_same(const Corners& found, const Corners& wanted, const std::string& what) {
    ASSERT_EQ(found.size(), wanted.size()) << what;
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_LT((found[i] - wanted[i]).norm(), 1e-6)
            << what << ", corner " << i << ": " << found[i].transpose();
}

TEST(MeshFile, has_the_same_points_in_each_format_unit_and_up_axis) {
    const ScratchFolder folder;
    std::vector<std::filesystem::path> files{folder.write("binary.stl", testing_support::wedge_stl()),
                                             folder.write("ascii.STL", testing_support::wedge_ascii_stl()),
                                             folder.write("wedge.obj", testing_support::wedge_obj())};
    for (const char* const up : {"X_UP", "Y_UP", "Z_UP"}) {
        for (const double unit_m : {1.0, 0.001, 0.0254}) {
            files.push_back(folder.write(std::string(up) + std::to_string(unit_m) + ".dae",
                                         testing_support::wedge_dae(up, unit_m)));
        }
    }
    const Corners wanted = wedge_moved([](const Vector3d& at) { return at; });
    for (const auto& file : files) {
        const auto mesh = read_mesh(file);
        ASSERT_TRUE(mesh) << mesh.error();
        expect_same(corners_of(*mesh), wanted, file.string());
    }
}

TEST(MeshFile, applies_the_transform_of_an_inner_node_in_the_unit_of_the_file) {
    const ScratchFolder folder;
    const std::string node =
        "<translate>100 200 300</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale>";
    const auto mesh = read_mesh(folder.write("node.dae", testing_support::wedge_dae("Y_UP", 0.001, node)));
    ASSERT_TRUE(mesh) << mesh.error();
    expect_same(corners_of(*mesh), wedge_moved([](const Vector3d& at) {
                    return Vector3d(0.1 - at.y(), 0.2 + 2.0 * at.x(), 0.3 + at.z());
                }),
                "node.dae");
}

TEST(MeshFile, applies_a_transform_that_is_close_to_none) {
    constexpr double kTurn = 0.3 * 3.14159265358979323846 / 180.0;
    const auto same = [](const Vector3d& at) { return at; };
    const auto turned = [](const Vector3d& at) {
        return Vector3d(at.x() * std::cos(kTurn) - at.y() * std::sin(kTurn),
                        at.x() * std::sin(kTurn) + at.y() * std::cos(kTurn), at.z());
    };
    const std::vector<std::pair<std::string, std::function<Vector3d(const Vector3d&)>>> cases{
        {"<translate>0 0 0</translate>", same},
        {"<translate>0 0.003 0</translate>",
         [](const Vector3d& at) { return Vector3d(at.x(), at.y() + 0.003, at.z()); }},
        {"<translate>1 0 0</translate>",
         [](const Vector3d& at) { return Vector3d(at.x() + 1.0, at.y(), at.z()); }},
        {"<rotate>0 0 1 0.3</rotate>", turned},
        {"<rotate>0 0 1 0.3</rotate><translate>1 0 0</translate>",
         [&](const Vector3d& at) { return turned(at + Vector3d::UnitX()); }},
        {"<scale>1.005 1.005 1.005</scale>", [](const Vector3d& at) { return Vector3d(1.005 * at); }},
        {"<scale>1 1 -1</scale>", [](const Vector3d& at) { return Vector3d(at.x(), at.y(), -at.z()); }}};
    const ScratchFolder folder;
    for (const auto& [node, move] : cases) {
        const auto mesh = read_mesh(folder.write("close.dae", testing_support::wedge_dae("Z_UP", 1.0, node)));
        ASSERT_TRUE(mesh) << mesh.error();
        expect_same(corners_of(*mesh), wedge_moved(move), node);
    }
}

/// Positive if the corners run anticlockwise seen from outside.
double volume_of(const TriangleMesh& mesh) {
    double volume = 0.0;
    for (const auto& triangle : mesh.triangles) {
        const auto corner = [&](int i) { return mesh.vertices[static_cast<std::size_t>(triangle[i])]; };
        volume += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
    }
    return volume;
}

TEST(MeshFile, has_corners_that_run_anticlockwise_in_a_mirrored_part) {
    const ScratchFolder folder;
    for (const char* const node : {"", "<scale>1 1 -1</scale>", "<scale>-1 -1 -1</scale>"}) {
        const auto mesh = read_mesh(folder.write("a.dae", testing_support::wedge_dae("Z_UP", 1.0, node)));
        ASSERT_TRUE(mesh) << mesh.error();
        EXPECT_GT(volume_of(*mesh), 0.0) << node;
    }
}

TEST(MeshFile, has_each_instance_of_a_part_at_its_place) {
    const ScratchFolder folder;
    std::string text = testing_support::wedge_dae("Z_UP", 1.0);
    text.insert(text.find("</visual_scene>"),
                "<node><translate>0 0 0.003</translate><instance_geometry url=\"#wedge\"/></node>");
    const auto mesh = read_mesh(folder.write("two.dae", text));
    ASSERT_TRUE(mesh) << mesh.error();
    Corners wanted = wedge_moved([](const Vector3d& at) { return at; });
    for (const Vector3d& at :
         wedge_moved([](const Vector3d& from) { return Vector3d(from + Vector3d(0, 0, 0.003)); }))
        wanted.push_back(at);
    expect_same(corners_of(*mesh), sorted(wanted), "two.dae");
}

/// Prints the corners in metres, without the up axis: what pycollada calls the bound geometry.
constexpr const char* kForeignReader = R"(import sys, collada
d = collada.Collada(sys.argv[1]); u = d.assetInfo.unitmeter
for g in d.scene.objects('geometry'):
    for p in g.primitives():
        for t in p:
            for v in t.vertices: print(*[float(c) * u for c in v])
)";

TEST(MeshFile, of_collada_agrees_with_a_reader_that_is_not_assimp) {
    if (std::system("/usr/bin/python3 -c 'import collada' 2> /dev/null") != 0)
        GTEST_SKIP() << "python3-collada is not installed";
    const ScratchFolder folder;
    const auto script = folder.write("read.py", kForeignReader);
    const std::string node =
        "<translate>10 -20 30</translate><rotate>0.2857142857 0.4285714286 0.8571428571 40</rotate>";
    for (const char* const up : {"Y_UP", "Z_UP"}) {
        const auto file = folder.write("node.dae", testing_support::wedge_dae(up, 0.01, node));
        const std::string command = "/usr/bin/python3 " + script.string() + " " + file.string();
        const std::unique_ptr<FILE, int (*)(FILE*)> output(::popen(command.c_str(), "r"), ::pclose);
        Corners foreign;
        for (Vector3d at; std::fscanf(output.get(), "%lf %lf %lf", &at.x(), &at.y(), &at.z()) == 3;)
            foreign.push_back(at);
        const auto mesh = read_mesh(file);
        ASSERT_TRUE(mesh) << mesh.error();
        ASSERT_EQ(foreign.size(), 12U);
        expect_same(corners_of(*mesh), sorted(foreign), up);
    }
}

TEST(MeshFile, has_no_part_of_points_and_lines) {
    const ScratchFolder folder;
    const auto file = folder.write("a.obj", testing_support::wedge_obj() + "v 9 9 9\nv 8 8 8\nl 5 6\np 5\n");
    const auto mesh = read_mesh(file);
    ASSERT_TRUE(mesh) << mesh.error();
    EXPECT_EQ(mesh->triangles.size(), 4U);
    EXPECT_LE(mesh->vertices.size(), 12U);
    for (const Vector3d& vertex : mesh->vertices) EXPECT_LT(vertex.cwiseAbs().maxCoeff(), 2.0);
}

TEST(MeshFile, is_not_read_in_part) {
    const ScratchFolder folder;
    const std::string stl = testing_support::wedge_ascii_stl();
    const std::string dae = testing_support::wedge_dae("Z_UP", 0.001);
    const auto with_node = [&](const std::string& node) {
        std::string text = dae;
        const auto at = text.find("</visual_scene>");
        EXPECT_NE(at, std::string::npos);
        return text.insert(at, "<node>" + node + "</node>");
    };
    for (const auto& [name, text] :
         {std::pair{"cut.stl", stl.substr(0, stl.rfind("endsolid"))},
          std::pair{"more.stl", stl + stl.substr(6)},
          std::pair{"dots.obj", "v .5 0 0\n" + testing_support::wedge_obj()},
          std::pair{"capitals.obj", testing_support::wedge_obj() + "F 1 2 3\n"},
          std::pair{"other.dae", with_node("<instance_node url=\"other.dae#n\"/>")},
          std::pair{"none.dae", with_node("<instance_geometry url=\"#none\"/>")}})
        EXPECT_FALSE(read_mesh(folder.write(name, text))) << name;
    ASSERT_TRUE(read_mesh(folder.write("whole.dae", with_node(""))));
}

/// The wedge's file with `from` replaced by `to`.
std::string wedge_with(const std::string& from, const std::string& to) {
    std::string text = testing_support::wedge_dae("Z_UP", 1.0);
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(MeshFile, has_the_triangles_of_each_surface_that_the_text_of_collada_has) {
    const ScratchFolder folder;
    const std::string input = "<input semantic=\"VERTEX\" source=\"#vertices\" offset=\"0\"/>";
    const std::string triangles =
        "<triangles count=\"4\">" + input + "<p>0 2 1 0 1 3 1 2 3 2 0 3 </p></triangles>";
    for (const auto& [surface, count] :
         {std::pair{triangles, 4U}, std::pair{triangles + triangles, 8U},
          std::pair{"<polylist count=\"2\">" + input + "<vcount>3 4</vcount><p>0 2 1 0 1 3 2</p></polylist>",
                    3U},
          std::pair{"<polygons count=\"2\">" + input + "<p>0 2 1</p><p>0 1 3</p></polygons>", 2U},
          std::pair{"<tristrips count=\"2\">" + input + "<p>0 2 1 3</p><p>0 1 3</p></tristrips>", 3U},
          std::pair{triangles + "<lines count=\"1\">" + input + "<p>0 1</p></lines>", 4U}}) {
        const auto mesh = read_mesh(folder.write("surface.dae", wedge_with(triangles, surface)));
        ASSERT_TRUE(mesh) << mesh.error() << surface;
        EXPECT_EQ(mesh->triangles.size(), count) << surface;
    }
}

TEST(MeshFile, of_collada_has_no_surfaces_that_only_one_of_the_readers_finds) {
    const ScratchFolder folder;
    const std::string extra =
        "<extra><technique profile=\"x\"><triangles count=\"1\"><input semantic=\"VERTEX\" "
        "source=\"#vertices\" offset=\"0\"/><p>0 1 2</p></triangles></technique></extra>";
    const auto mesh = read_mesh(folder.write("extra.dae", wedge_with("</mesh>", extra + "</mesh>")));
    ASSERT_FALSE(mesh);
    EXPECT_NE(mesh.error().find("has 4 triangles in its text, and 5 are read"), std::string::npos)
        << mesh.error();
}

TEST(MeshFile, opens_only_the_files_that_are_allowed) {
    class None final : public AllowedFiles {
        [[nodiscard]] Result<std::filesystem::path, std::string> openable(
            const std::filesystem::path& /*file*/) const override {
            return unexpected(std::string("no"));
        }
    };
    const ScratchFolder folder;
    const None none;
    EXPECT_FALSE(read_mesh(folder.write("a.stl", testing_support::wedge_stl()), &none));
}

TEST(MeshFile, refuses_other_endings_and_damaged_content) {
    const ScratchFolder folder;
    EXPECT_FALSE(read_mesh(folder.write("a.ply", testing_support::wedge_stl())));
    EXPECT_FALSE(read_mesh(folder.write("empty.stl", "")));
    EXPECT_FALSE(read_mesh(folder.write("text.dae", "no mesh")));
    const std::string whole = testing_support::wedge_stl();
    for (std::size_t bytes = 0; bytes < whole.size(); bytes += 7)
        EXPECT_FALSE(read_mesh(folder.write("cut.stl", whole.substr(0, bytes)))) << bytes;
}

TEST(MeshPolygons, that_cannot_be_cut_into_triangles_are_refused) {
    const testing_support::ScratchFolder folder;
    const auto file = folder.write("a.obj",
                                   "v 0 0 0\nv 0.5 0.5 0\nv 0.5 0 0\nv 0 0.5 0\nv 0.2 0.9 0\nv 0.9 0.1 0\n"
                                   "v 0.1 0.2 0\nv 0 0 1\nf 1 2 3 4 5 6 7\nf 1 2 8\n");
    const auto mesh = read_mesh(file);
    ASSERT_FALSE(mesh);
    EXPECT_NE(mesh.error().find("3 of 6"), std::string::npos) << mesh.error();
}

}  // namespace
}  // namespace octoskin
