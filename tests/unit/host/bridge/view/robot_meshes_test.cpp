// Which files of the machine a client of the view can have.
#include "host/bridge/view/robot_meshes.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::view {
namespace {

class RobotMeshesTest : public ::testing::Test {
  protected:
    RobotMeshesTest() {
        std::filesystem::create_directories(folder / "arm/meshes");
        folder.write("arm/meshes/link.stl", "a mesh");
        folder.write("arm/meshes/hand.DAE", "another");
        folder.write("arm/meshes/secret.txt", "secret");
        folder.write("secret.stl", "secret");
        std::filesystem::create_symlink(folder / "secret.stl", folder / "arm/meshes/linked.stl");
    }
    std::string read(const std::string& uri) const {
        const auto bytes = meshes.read(uri);
        return bytes ? *bytes : "none";
    }
    /// The URDF names it.
    std::string read_named(const std::string& uri) {
        meshes.on_urdf("<robot><mesh filename=\"" + uri + "\"/></robot>");
        return read(uri);
    }

    testing_support::ScratchFolder folder;
    RobotMeshes meshes{MeshSearch{{{"arm", folder / "arm"}}, "", ""}};
};

TEST_F(RobotMeshesTest, are_those_of_a_package_that_the_urdf_names) {
    const std::string link = "package://arm/meshes/link.stl";
    EXPECT_EQ(read(link), "none") << "no robot is known";
    EXPECT_EQ(read_named(link), "a mesh");
    EXPECT_EQ(read_named("package://arm/meshes/hand.DAE"), "another");
    EXPECT_EQ(read(link), "none") << "of another robot";
}

TEST_F(RobotMeshesTest, are_no_other_files_whatever_the_urdf_names) {
    const std::string secret = (folder / "secret.stl").string();
    const std::string package = folder.path().filename().string();
    for (const std::string& uri :
         {std::string("package://arm/meshes/secret.txt"), std::string("package://arm/meshes/none.stl"),
          std::string("package://arm/../secret.stl"), std::string("package://arm/meshes/linked.stl"),
          "package://" + package + "/secret.stl", "file://" + secret, secret, std::string("secret.stl"),
          std::string("http://localhost/secret.stl"), std::string("package://../secret.stl"),
          std::string(".stl"), std::string()})
        EXPECT_EQ(read_named(uri), "none") << uri;
    meshes.on_urdf("package://arm/meshes/link.stl.stl");
    EXPECT_EQ(read("package://arm/meshes/link.stl"), "none") << "part of a name";
}

TEST_F(RobotMeshesTest, have_a_limit_of_size) {
    folder.write("arm/meshes/large.stl", std::string(RobotMeshes::kBytesMax + 1, 'x'));
    EXPECT_EQ(read_named("package://arm/meshes/large.stl"), "none");
}

}  // namespace
}  // namespace octoskin::view
