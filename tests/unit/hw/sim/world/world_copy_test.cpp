#include "hw/sim/world/world_copy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::sim {
namespace {

using testing::HasSubstr;
using testing_support::ScratchFolder;

std::string world_of(const std::string& uris) {
    return "<sdf version=\"1.7\"><world name=\"w\">" + uris + "</world></sdf>\n";
}
std::string mesh(const std::string& uri) {
    return "<mesh><uri>" + uri + "</uri></mesh>";
}

TEST(WorldCopy, without_meshes_is_the_same_byte_for_byte) {
    const ScratchFolder scratch;
    const std::string text = world_of("<uri>model://x</uri>  <!-- a comment -->");
    const auto copy = copy_of_world(scratch.write("a.sdf", text), {});
    ASSERT_TRUE(copy) << copy.error();
    EXPECT_EQ(copy->sdf, text);
    EXPECT_TRUE(copy->meshes.empty());
}

TEST(WorldCopy, gives_each_mesh_one_name_of_a_fixed_scheme) {
    const ScratchFolder scratch;
    std::filesystem::create_directory(scratch / "meshes");
    scratch.write("meshes/a b.STL", "one");
    scratch.write("two.obj", "two");
    const auto copy = copy_of_world(
        scratch.write("a.sdf",
                      world_of(mesh("meshes/a b.STL") + mesh(" file://two.obj\n") + mesh("meshes/a b.STL"))),
        {"meshes/a b.STL", "file://two.obj"});
    ASSERT_TRUE(copy) << copy.error();
    ASSERT_EQ(copy->meshes.size(), 2U);
    EXPECT_EQ(copy->meshes[0].name, "mesh_01.stl");
    EXPECT_EQ(copy->meshes[0].bytes, "one");
    EXPECT_EQ(copy->meshes[1].name, "mesh_02.obj");
    EXPECT_EQ(copy->meshes[1].bytes, "two");
    const auto first = copy->sdf.find("<uri>mesh_01.stl</uri>");
    const auto second = copy->sdf.find("<uri>mesh_02.obj</uri>");
    const auto third = copy->sdf.rfind("<uri>mesh_01.stl</uri>");
    EXPECT_LT(first, second);
    EXPECT_LT(second, third);
    EXPECT_EQ(copy->sdf.find("a b.STL"), std::string::npos);
}

TEST(WorldCopy, is_of_what_is_written_out_in_place_of_the_file) {
    const ScratchFolder scratch;
    scratch.write("one.stl", "one");
    const auto file = scratch.write("a.sdf", world_of("<include><uri>model</uri></include>"));
    const std::string uri = (scratch / "one.stl").string();
    const auto copy = copy_of_world(file, {uri}, world_of(mesh(uri)));
    ASSERT_TRUE(copy) << copy.error();
    ASSERT_EQ(copy->meshes.size(), 1U);
    EXPECT_EQ(copy->meshes[0].bytes, "one");
    EXPECT_NE(copy->sdf.find("<uri>mesh_01.stl</uri>"), std::string::npos);
    EXPECT_FALSE(copy_of_world(file, {}, world_of(std::string(kWorldBytesMax, ' '))));
}

TEST(WorldCopy, leaves_out_what_the_world_calls_a_mesh_and_was_not_read_as_one) {
    const ScratchFolder scratch;
    scratch.write("one.stl", "one");
    scratch.write("other.stl", "a secret");
    const auto copy = copy_of_world(
        scratch.write("a.sdf", world_of(mesh("one.stl") + mesh("other.stl") + mesh("none.stl") +
                                        mesh("one.stl") + mesh("/etc/passwd") + mesh("other.stl"))),
        {"one.stl"});
    ASSERT_TRUE(copy) << copy.error();
    ASSERT_EQ(copy->meshes.size(), 1U);
    EXPECT_EQ(copy->meshes[0].bytes, "one");
    EXPECT_EQ(copy->left_out, (std::vector<std::string>{"/etc/passwd", "none.stl", "other.stl"}));
    for (const std::string& left_out : copy->left_out)
        EXPECT_EQ(copy->sdf.find(left_out), std::string::npos) << left_out;
}

TEST(WorldCopy, that_cannot_be_made_says_why) {
    const ScratchFolder scratch;
    scratch.write("plain", "no ending");
    scratch.write("evil.a-b", "an ending of other characters");
    scratch.write("long.abcdefghi", "an ending of nine");
    scratch.write("secret.json", "of a kind that no mesh is");
    std::vector<std::string> uris{"none.stl",       "plain",       "evil.a-b",
                                  "long.abcdefghi", "secret.json", "large.stl"};
    const auto refusal = [&](const std::string& within) {
        const auto copy = copy_of_world(scratch.write("a.sdf", world_of(within)), uris);
        return copy ? "it was made" : copy.error();
    };
    EXPECT_THAT(refusal("<include><uri>model</uri></include>"), HasSubstr("includes other models"));
    EXPECT_THAT(refusal(mesh("none.stl")), HasSubstr("none.stl"));
    for (const char* name : {"plain", "evil.a-b", "long.abcdefghi", "secret.json"})
        EXPECT_THAT(refusal(mesh(name)), HasSubstr("does not have the ending of a mesh file")) << name;
    std::string many;
    for (int i = 0; i < 100; ++i) {
        const std::string name = "m" + std::to_string(i) + ".stl";
        scratch.write(name, "m");
        many += mesh(name);
        uris.push_back(name);
    }
    EXPECT_THAT(refusal(many), HasSubstr("has more than 99 meshes"));
    EXPECT_FALSE(copy_of_world(scratch.write("b.sdf", "no XML at all <"), {}));
    EXPECT_FALSE(copy_of_world(scratch / "none.sdf", {}));
    scratch.write("large.stl", "");
    std::filesystem::resize_file(scratch / "large.stl", kMeshBytesMax + 1);
    EXPECT_THAT(refusal(mesh("large.stl")), HasSubstr("has more than 64 MiB"));
}

}  // namespace
}  // namespace octoskin::sim
