// Which mesh files a world may have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "hw/sim/world/world.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::what_is;

/// Each a triangle, but for its format.
const std::map<std::string, std::string> kTriangles{
    {"obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
    {"stl",
     "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
     "endfacet\nendsolid s\n"},
    {"dae",
     R"(<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><library_geometries>
<geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION"
source="#p"/></vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry
url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)"},
    {"ply",
     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement "
     "face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
    {"off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
};

TEST(MeshKinds, are_three_and_no_other_reader_is_tried) {
    const testing_support::ScratchFolder scratch;
    const auto read = [&](const std::string& name, const std::string& bytes) {
        const std::string mesh = scratch.write(name, bytes).string();
        return World::read(scratch.write(
            "w.sdf",
            "<sdf version='1.6'><world name='w'><model name='m'><link name='l'><visual name='v'>"
            "<geometry><mesh><uri>" +
                mesh +
                "</uri></mesh></geometry></visual></link></model>"
                "</world></sdf>"));
    };
    for (const char* name : {"m.obj", "m.stl", "m.dae", "M.STL"}) {
        std::string kind = std::string(name).substr(2);
        if (kind == "STL") kind = "stl";
        const auto mesh = read(name, kTriangles.at(kind));
        ASSERT_TRUE(mesh) << mesh.error().message();
        EXPECT_EQ(mesh->solids()[0].triangles.size(), 1U) << name;
    }
    for (const char* name : {"m.ply", "m.off", "m.glb", "m", "m.obj.zip", "m."}) {
        const std::string kind = std::string(name) == "m.off" ? "off" : "ply";
        const auto mesh = read(name, kTriangles.at(kind));
        ASSERT_FALSE(mesh) << name;
        EXPECT_THAT(mesh.error(), what_is(AllOf(HasSubstr(std::string("/") + name), HasSubstr(".stl"))));
    }
    // What is inside does not bring another reader in.
    for (const char* name : {"m.obj", "m.stl", "m.dae"}) {
        EXPECT_FALSE(read(name, kTriangles.at("ply"))) << name;
    }
}

}  // namespace
}  // namespace octoskin::sim
