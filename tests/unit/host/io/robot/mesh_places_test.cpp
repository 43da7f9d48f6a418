#include "host/io/robot/mesh_places.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

class MeshPlacesTest : public testing::Test {
  protected:
    fs::path make(const std::string& name) const {
        fs::create_directories((folder_ / name).parent_path());
        return folder_.write(name, "x");
    }
    [[nodiscard]] std::string found(const std::string& uri, const MeshSearch& search = {}) const {
        const auto place = MeshPlaces(folder_ / "ws/src/arm/urdf/arm.urdf", search).find(uri);
        if (!place) return std::string(name_of(place.error().code));
        return place->shown().lexically_relative(folder_.path()).string();
    }

    testing_support::ScratchFolder folder_;
};

TEST_F(MeshPlacesTest, finds_a_package_in_each_kind_of_folder) {
    make("ws/src/arm/meshes/a.stl");
    make("ws/src/hand/a.stl");
    make("given/a.stl");
    make("ros/tool/a.stl");
    make("ament/share/rail/a.stl");
    EXPECT_EQ(found("package://arm/meshes/a.stl"), "ws/src/arm/meshes/a.stl");  // the name of a folder above
    EXPECT_EQ(found("package://hand/a.stl"), "ws/src/hand/a.stl");              // beside one
    EXPECT_EQ(found("package://any/a.stl"), "not_found");
    EXPECT_EQ(found("package://any/a.stl", {{{"any", folder_ / "given"}}, "", ""}), "given/a.stl");
    EXPECT_EQ(found("package://tool/a.stl", {{}, "/none:" + (folder_ / "ros").string(), ""}),
              "ros/tool/a.stl");
    EXPECT_EQ(found("package://tool/a.stl", {{}, (folder_ / "ros/tool/").string(), ""}), "ros/tool/a.stl");
    EXPECT_EQ(found("package://rail/a.stl", {{}, "", (folder_ / "ament").string()}),
              "ament/share/rail/a.stl");
}

TEST_F(MeshPlacesTest, finds_a_file_in_a_copy_of_its_package_under_another_name) {
    make("ws/src/arm/meshes/a.stl");
    make("ws/src/b.stl");
    EXPECT_EQ(found("package://other/meshes/a.stl"), "ws/src/arm/meshes/a.stl");
    EXPECT_EQ(found("package://other/b.stl"), "not_found");  // not above the folder of relative paths
    folder_.write("ws/src/arm/package.xml", "<package><name> arm_description\n</name></package>");
    EXPECT_EQ(found("package://other/meshes/a.stl"), "not_found");  // it is another package
    EXPECT_EQ(found("package://arm_description/meshes/a.stl"), "ws/src/arm/meshes/a.stl");
    EXPECT_EQ(found("package://arm/meshes/a.stl"), "ws/src/arm/meshes/a.stl");
}

TEST_F(MeshPlacesTest, only_the_first_package_of_a_name_counts) {
    make("ws/src/arm/a.stl");
    make("ws/src/arm/b.stl");
    make("given/a.stl");
    const MeshSearch search{{{"arm", folder_ / "given"}}, "", ""};
    EXPECT_EQ(found("package://arm/a.stl", search), "given/a.stl");
    EXPECT_EQ(found("package://arm/b.stl", search), "not_found");
    EXPECT_EQ(found("package://arm/a.stl", {{{"arm", folder_ / "no_folder"}}, "", ""}), "not_found");
    EXPECT_EQ(found("package://arm/a.stl", {{{"arm", folder_ / "given/a.stl"}}, "", ""}), "not_found");
    make("over/arm/a.stl");
    make("under/arm/b.stl");
    const MeshSearch overlay{{}, (folder_ / "over").string() + ":" + (folder_ / "under").string(), ""};
    EXPECT_EQ(found("package://arm/a.stl", overlay), "over/arm/a.stl");
    EXPECT_EQ(found("package://arm/b.stl", overlay), "not_found");
}

TEST_F(MeshPlacesTest, links_in_the_path_that_the_user_typed_are_followed) {
    make("ws/src/arm/urdf/a.stl");
    fs::create_directory_symlink(folder_ / "ws/src/arm/urdf", folder_ / "ws/src/link");
    const auto place = MeshPlaces(folder_ / "ws/src/link/arm.urdf", {}).find("a.stl");
    ASSERT_TRUE(place) << place.error().message();
    EXPECT_TRUE(place->open());
}

TEST_F(MeshPlacesTest, finds_relative_and_absolute_files_below_the_package_and_refuses_others) {
    make("ws/src/arm/urdf/a.stl");
    make("ws/src/arm/meshes/a.stl");
    make("ws/src/secret.stl");
    EXPECT_EQ(found("a.stl"), "ws/src/arm/urdf/a.stl");
    EXPECT_EQ(found("../meshes/a.stl"), "ws/src/arm/meshes/a.stl");
    EXPECT_EQ(found("file://" + (folder_ / "ws/src/arm/meshes/a.stl").string()), "ws/src/arm/meshes/a.stl");
    EXPECT_EQ(found("../../secret.stl"), "outside_folder");
    EXPECT_EQ(found("meshes/../../../secret.stl"), "outside_folder");
    EXPECT_EQ(found("/etc/passwd"), "outside_folder");
    EXPECT_EQ(found("file:///etc/passwd"), "outside_folder");
    EXPECT_EQ(found("package://arm/../secret.stl"), "outside_folder");
    EXPECT_EQ(found("package://../secret.stl"), "bad_value");
    EXPECT_EQ(found("http://host/a.stl"), "unsupported");
    make("ws/package.xml");  // then its folder is the root
    EXPECT_EQ(found("../../secret.stl"), "ws/src/secret.stl");
}

TEST_F(MeshPlacesTest, a_link_below_a_package_is_found_but_not_followed) {
    make("secret.stl");
    make("ws/src/arm/a.stl");
    fs::create_symlink(folder_ / "secret.stl", folder_ / "ws/src/arm/link.stl");
    const auto place = MeshPlaces(folder_ / "ws/src/arm/urdf/arm.urdf", {}).find("package://arm/link.stl");
    ASSERT_TRUE(place);
    const auto opened = place->open();
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().fault, FolderFault::link);
}

TEST_F(MeshPlacesTest, a_link_named_as_the_package_is_not_followed) {
    make("secret/a.stl");
    make("ws/src/arm/urdf/arm.urdf");
    fs::create_directory_symlink(folder_ / "secret", folder_ / "ws/src/tool");
    const auto place = MeshPlaces(folder_ / "ws/src/arm/urdf/arm.urdf", {}).find("package://tool/a.stl");
    EXPECT_TRUE(!place || !place->open());
}

TEST_F(MeshPlacesTest, a_folder_far_above_is_a_package_by_its_name_only_with_a_package_xml) {
    make("ws/src/arm/urdf/arm.urdf");
    make("ws/a.stl");
    EXPECT_EQ(found("package://ws/a.stl"), "not_found");
    make("ws/package.xml");
    EXPECT_EQ(found("package://ws/a.stl"), "ws/a.stl");
}

TEST_F(MeshPlacesTest, all_meshes_of_a_recording_are_in_its_folder) {
    make("given/a.stl");
    make("rec/arm.urdf");
    make("rec/arm/b.stl");
    make("rec/c.stl");
    make("d.stl");
    const MeshPlaces places(FilePlace(NamedFolder(folder_ / "rec"), "arm.urdf"),
                            {{{"arm", folder_ / "given"}}, (folder_ / "given").string(), ""});
    const auto code_of = [&](const std::string& uri) { return places.find(uri).error().code; };
    EXPECT_EQ(code_of("package://arm/a.stl"), ErrorCode::not_found);
    EXPECT_EQ(code_of("../d.stl"), ErrorCode::outside_folder);
    EXPECT_EQ(code_of("package://../d.stl"), ErrorCode::outside_folder);
    EXPECT_EQ(code_of("file://" + (folder_ / "d.stl").string()), ErrorCode::outside_folder);
    for (const char* good : {"package://arm/b.stl", "package://arm/c.stl", "c.stl"}) {
        const auto place = places.find(good);
        ASSERT_TRUE(place) << good;
        EXPECT_NE(place->folder(), nullptr);
        EXPECT_TRUE(place->open()) << good;
    }
}

TEST(PackagePath, has_a_name_and_a_folder) {
    EXPECT_EQ(package_path_of("a=/b=c")->folder, "/b=c");
    for (const char* bad : {"", "a", "=b", "a="}) EXPECT_FALSE(package_path_of(bad)) << bad;
}

}  // namespace
}  // namespace octoskin
